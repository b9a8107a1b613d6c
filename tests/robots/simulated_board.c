/* An ATmega328P in simavr, with its serial line on a pseudo-terminal and a count of the edges of STEP.
 *
 *   cc simulated_board.c -lsimavr -lutil -o board
 *   ./board stepper.elf counts             in real time
 *   ./board stepper.elf counts stepped     a millisecond for each byte of standard input, then prints "ms"
 *
 * Prints the path of the pseudo-terminal, and keeps writing "rising edges, net position, largest delay in ms" to the
 * file `counts`; the delay is that of the board behind the wall clock. Ends when its standard input is closed.
 */
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define CYCLES_PER_BYTE 1400 /* 115200 baud at 16 MHz */

static int terminal;
static long edges, position, late;
static bool forwards, may_send = true;

static void on_step(struct avr_irq_t *irq, uint32_t value, void *unused)
{
    if (value) {
        edges++;
        position += forwards ? 1 : -1;
    }
}

static void on_direction(struct avr_irq_t *irq, uint32_t value, void *unused)
{
    forwards = value;
}

static void on_byte(struct avr_irq_t *irq, uint32_t value, void *unused)
{
    uint8_t byte = value;
    if (write(terminal, &byte, 1) != 1) {
        /* A line loses bytes that are not read. */
    }
}

static void on_xon(struct avr_irq_t *irq, uint32_t value, void *unused) { may_send = true; }
static void on_xoff(struct avr_irq_t *irq, uint32_t value, void *unused) { may_send = false; }

/* The simulator's own sleep would wait for the wall clock a second time. */
static void no_sleep(avr_t *avr, avr_cycle_count_t cycles) {}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

/* A reader finds either the old file or the new one. */
static void write_counts(const char *path)
{
    char part[4096];
    snprintf(part, sizeof part, "%s.part", path);
    FILE *counts = fopen(part, "w");
    if (!counts)
        return;
    fprintf(counts, "%ld %ld %ld\n", edges, position, late);
    fclose(counts);
    rename(part, path);
}

int main(int count, char **arguments)
{
    if (count != 3 && count != 4)
        return 2;
    bool stepped = count == 4, first = true;
    /* A real board has a processor of its own, which no load of this machine slows down. Only root may do this. */
    setpriority(PRIO_PROCESS, 0, -20);
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(arguments[1], &firmware))
        return 1;
    avr_t *avr = avr_make_mcu_by_name("atmega328p");
    if (!avr)
        return 1;
    avr_init(avr);
    avr->frequency = 16000000;
    avr_load_firmware(avr, &firmware);
    avr->sleep = no_sleep;

    char name[64];
    int other;
    struct termios raw;
    cfmakeraw(&raw);
    if (openpty(&terminal, &other, name, &raw, NULL))
        return 1;
    fcntl(terminal, F_SETFL, O_NONBLOCK);

    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_t *from_board = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT);
    avr_irq_t *to_board = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(from_board, on_byte, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XON), on_xon, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XOFF), on_xoff, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 2), on_direction, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 3), on_step, NULL);

    printf("%s\n", name);
    fflush(stdout);
    double start = now();
    avr_cycle_count_t next_byte = 0, next_look = 0;
    for (;;) {
        int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed)
            return 1;
        if (avr->cycle >= next_byte) {
            uint8_t byte;
            if (may_send && read(terminal, &byte, 1) == 1)
                avr_raise_irq(to_board, byte);
            next_byte = avr->cycle + CYCLES_PER_BYTE;
        }
        if (avr->cycle >= next_look) {
            /* Not ahead of the wall clock; a late board catches up. */
            double ahead = avr->cycle / 16e6 - (now() - start);
            if (-1e3 * ahead > late)
                late = -1e3 * ahead;
            write_counts(arguments[2]);
            struct pollfd input = { 0, POLLIN, 0 };
            char ignored;
            if (stepped && !first) {
                printf("ms\n");
                fflush(stdout);
            }
            first = false;
            if ((stepped || poll(&input, 1, 0) > 0) && read(0, &ignored, 1) <= 0)
                return 0;
            if (!stepped && ahead > 0)
                usleep(1e6 * ahead);
            next_look = avr->cycle + (stepped ? 16000 : 32000); /* 1 or 2 ms */
        }
    }
}
