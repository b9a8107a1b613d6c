/* Firmware of the stepper that twists the rod's end, for an ATmega328P at 16 MHz (Arduino Uno).
 *
 * avr-gcc -mmcu=atmega328p -DF_CPU=16000000UL -Os -Wall -o stepper.elf stepper.c
 * avr-objcopy -O ihex stepper.elf stepper.hex && avrdude -p atmega328p -c arduino -P /dev/ttyACM0 -U flash:w:stepper.hex
 *
 * STEP is PD3 (pin 3), DIR is PD2 (pin 2), ENABLE (low) is PD4 (pin 4). 115200 baud, 8N1.
 *
 * Frames: sequence, kind, data, CRC-16/GENIBUS (high byte first), COBS-stuffed, then a zero. Numbers are little-endian.
 *   0x01 hello                     restart: empties the queue, resets the watchdog, sets the sequence
 *   0x02 move  i32 steps, u32 us   so many steps, evenly spread over so many microseconds
 *   0x03 status
 *   0x04 hold                      stop and empty the queue
 * Every good frame is answered by 0x81: u8 status, u8 free places, i32 position, u8 flags (1: watchdog).
 *   status 0 taken, 1 queue full, 2 refused, 3 stopped by the watchdog, 4 out of sequence
 * A frame with the number of the one before is answered as that was, and not done again; a move that found the queue
 * full is sent again under a new number.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdbool.h>
#include <stdint.h>
#include <util/atomic.h>

#define STEP _BV(PD3)
#define DIRECTION _BV(PD2)
#define ENABLE _BV(PD4)
#define TICKS_PER_SECOND 20000UL
#define MICROSECONDS_PER_TICK (1000000UL / TICKS_PER_SECOND)
#define WATCHDOG_TICKS (TICKS_PER_SECOND * 3 / 10)
#define QUEUE 16u /* a power of two */
#define LONGEST 40u

enum { HELLO = 1, MOVE = 2, STATUS = 3, HOLD = 4, ACKNOWLEDGED = 0x81 };
enum { TAKEN, FULL, REFUSED, WATCHDOG, OUT_OF_SEQUENCE };

struct move {
    int32_t steps;
    uint32_t ticks;
};

static struct move queue[QUEUE];
static volatile uint8_t first, waiting;
static volatile int32_t position;
static volatile uint16_t silence;
static volatile bool moving, stopped_by_watchdog;

/* The move at hand: Bresenham's line of steps over ticks. */
static uint32_t steps_left_over, steps_in_move, ticks_in_move, tick;
static int8_t direction;

static volatile uint8_t received[128], transmitted[128];
static volatile uint8_t received_in, received_out, transmitted_in, transmitted_out;

static void stand_still(void)
{
    moving = false;
    waiting = 0;
    PORTD &= ~STEP;
}

ISR(TIMER1_COMPA_vect)
{
    PORTD &= ~STEP; /* a pulse lasts one tick */
    if (moving || waiting) {
        if (++silence > WATCHDOG_TICKS) {
            stand_still();
            stopped_by_watchdog = true;
            return;
        }
    }
    if (!moving) {
        if (!waiting)
            return;
        const struct move *next = &queue[first];
        direction = next->steps < 0 ? -1 : 1;
        steps_in_move = next->steps < 0 ? -(uint32_t)next->steps : (uint32_t)next->steps;
        ticks_in_move = next->ticks;
        steps_left_over = 0;
        tick = 0;
        first = (first + 1) % QUEUE;
        waiting--;
        moving = true;
        if (direction > 0)
            PORTD |= DIRECTION;
        else
            PORTD &= ~DIRECTION;
    }
    steps_left_over += steps_in_move;
    if (steps_left_over >= ticks_in_move) {
        steps_left_over -= ticks_in_move;
        PORTD |= STEP;
        position += direction;
    }
    if (++tick == ticks_in_move)
        moving = false;
}

ISR(USART_RX_vect)
{
    received[received_in] = UDR0;
    received_in = (received_in + 1) % sizeof received;
}

ISR(USART_UDRE_vect)
{
    if (transmitted_in == transmitted_out) {
        UCSR0B &= ~_BV(UDRIE0);
        return;
    }
    UDR0 = transmitted[transmitted_out];
    transmitted_out = (transmitted_out + 1) % sizeof transmitted;
}

static void transmit(uint8_t byte)
{
    uint8_t next = (transmitted_in + 1) % sizeof transmitted;
    while (next == transmitted_out)
        ;
    transmitted[transmitted_in] = byte;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        transmitted_in = next;
        UCSR0B |= _BV(UDRIE0);
    }
}

static uint16_t checksum(const uint8_t *bytes, uint8_t count)
{
    uint16_t crc = 0xFFFF;
    while (count--) {
        crc ^= (uint16_t)*bytes++ << 8;
        for (uint8_t bit = 0; bit < 8; bit++)
            crc = crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1;
    }
    /* Inverted: else a zero repeated behind a checksum that ends with one would pass. */
    return ~crc;
}

static void acknowledge(uint8_t sequence, uint8_t status)
{
    uint8_t plain[11];
    int32_t at;
    uint8_t free;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        at = position;
        free = QUEUE - waiting;
    }
    plain[0] = sequence;
    plain[1] = ACKNOWLEDGED;
    plain[2] = status;
    plain[3] = free;
    for (uint8_t k = 0; k < 4; k++)
        plain[4 + k] = (uint32_t)at >> 8 * k;
    plain[8] = stopped_by_watchdog;
    uint16_t crc = checksum(plain, 9);
    plain[9] = crc >> 8;
    plain[10] = crc;
    for (uint8_t from = 0; from <= sizeof plain;) {
        uint8_t to = from;
        while (to < sizeof plain && plain[to])
            to++;
        transmit(to - from + 1);
        for (uint8_t k = from; k < to; k++)
            transmit(plain[k]);
        from = to + 1;
    }
    transmit(0);
}

static uint32_t number(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static uint8_t take_move(const uint8_t *data)
{
    struct move move = { (int32_t)number(data), number(data + 4) / MICROSECONDS_PER_TICK };
    uint32_t steps = move.steps < 0 ? -(uint32_t)move.steps : (uint32_t)move.steps;
    if (stopped_by_watchdog)
        return WATCHDOG;
    /* A pulse takes one tick and a pause of one at least. */
    if (!move.ticks || steps > move.ticks / 2)
        return REFUSED;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (waiting == QUEUE)
            return FULL;
        queue[(first + waiting) % QUEUE] = move;
        waiting++;
    }
    return TAKEN;
}

static void take(const uint8_t *frame, uint8_t count)
{
    static uint8_t last, last_status;
    if (count < 4)
        return;
    uint16_t crc = (uint16_t)frame[count - 2] << 8 | frame[count - 1];
    if (checksum(frame, count - 2) != crc)
        return;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { silence = 0; }
    uint8_t sequence = frame[0], kind = frame[1], status = TAKEN, data = count - 4;
    if (kind == HELLO) {
        ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
        {
            stand_still();
            stopped_by_watchdog = false;
        }
        last = sequence;
        last_status = TAKEN;
    } else if (sequence == last) {
        /* The answer was lost; the command was executed or refused. */
        status = last_status;
    } else if (sequence != (uint8_t)(last + 1)) {
        status = OUT_OF_SEQUENCE;
    } else {
        if (kind == MOVE && data == 8)
            status = take_move(frame + 2);
        else if (kind == HOLD)
            ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { stand_still(); }
        else if (kind != STATUS)
            status = REFUSED;
        last = sequence;
        last_status = status;
    }
    acknowledge(sequence, status);
}

/* Undoes the stuffing in place; the number of bytes, 0 where it is damaged. */
static uint8_t unstuff(uint8_t *bytes, uint8_t count)
{
    uint8_t in = 0, out = 0;
    while (in < count) {
        uint8_t run = bytes[in++] - 1;
        if (run > count - in)
            return 0;
        while (run--)
            bytes[out++] = bytes[in++];
        if (in < count)
            bytes[out++] = 0;
    }
    return out;
}

int main(void)
{
    static uint8_t frame[LONGEST];
    uint8_t count = 0;
    bool too_long = false;

    DDRD |= STEP | DIRECTION | ENABLE;
    PORTD &= ~(STEP | ENABLE);
    UBRR0 = 16; /* 115200 baud at double speed */
    UCSR0A = _BV(U2X0);
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    OCR1A = F_CPU / 8 / TICKS_PER_SECOND - 1;
    TCCR1B = _BV(WGM12) | _BV(CS11);
    TIMSK1 = _BV(OCIE1A);
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;) {
        while (received_out != received_in) {
            uint8_t byte = received[received_out];
            received_out = (received_out + 1) % sizeof received;
            if (byte) {
                if (count < LONGEST)
                    frame[count++] = byte;
                else
                    too_long = true;
            } else {
                if (count && !too_long)
                    take(frame, unstuff(frame, count));
                count = 0;
                too_long = false;
            }
        }
        sleep_mode();
    }
}
