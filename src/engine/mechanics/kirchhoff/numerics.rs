//! The few numerical tools that the theories need.

/// Root of a continuous function between two points where its signs differ, to the last bit.
///
/// # Panics
/// If the signs at `a` and `b` agree: the bracket is wrong.
pub fn bisect(mut a: f64, mut b: f64, function: impl Fn(f64) -> f64) -> f64 {
    let sign = function(a).signum();
    assert!(
        sign * function(b) <= 0.0,
        "no change of sign between {a} and {b}"
    );
    loop {
        let middle = 0.5 * (a + b);
        if middle <= a.min(b) || middle >= a.max(b) {
            return middle;
        }
        if function(middle) * sign > 0.0 {
            a = middle;
        } else {
            b = middle;
        }
    }
}

/// Zero of a continuous function between two points, each with its value, where its signs differ:
/// inverse quadratic interpolation where it converges faster than bisection, else bisection
/// (Chandrupatla 1997). The zero of the chord over the last interval is returned, which is at most
/// `width` times its far end wide.
///
/// `function` gets an end of the interval, that on the side of the first point, and a place in it.
/// It returns its value with the place of evaluation, which may lie anywhere between the two.
///
/// # Errors
/// Those of `function`.
pub fn find_zero<E>(
    bracket: [(f64, f64); 2],
    width: f64,
    mut function: impl FnMut(f64, f64) -> Result<(f64, f64), E>,
) -> Result<f64, E> {
    let [mut opposite, mut newest] = bracket;
    let mut before: Option<(f64, f64)> = None;
    loop {
        let (a, b) = (newest, opposite);
        if a.1 == 0.0 {
            return Ok(a.0);
        }
        let length = (b.0 - a.0).abs();
        // Share of the interval, from its newest end, at which the chord is zero.
        let chord = a.1 / (a.1 - b.1);
        let least = 0.5 * width * a.0.abs().max(b.0.abs()) / length;
        if least >= 0.5 {
            return Ok(a.0 + chord * (b.0 - a.0));
        }
        let share = before.map_or(chord, |c| interpolated(a, b, c).unwrap_or(0.5));
        let share = share.clamp(least, 1.0 - least);
        let place = a.0 + share * (b.0 - a.0);
        let is_first = (a.1 > 0.0) == (bracket[0].1 > 0.0);
        let next = function(if is_first { a.0 } else { b.0 }, place)?;
        if (next.1 > 0.0) == (a.1 > 0.0) {
            before = Some(a);
        } else {
            before = Some(b);
            opposite = a;
        }
        newest = next;
    }
}

/// Share of the way from `a` to `b` at which the parabola through three points, which gives the
/// place as a function of the value, is zero; `None` where it is not monotonic enough.
fn interpolated(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let place = (a.0 - b.0) / (c.0 - b.0);
    let value = (a.1 - b.1) / (c.1 - b.1);
    let is_monotonic = value * value < place && (1.0 - value).powi(2) < 1.0 - place;
    is_monotonic.then(|| {
        a.1 / (b.1 - a.1) * c.1 / (b.1 - c.1)
            + (c.0 - a.0) / (b.0 - a.0) * a.1 / (c.1 - a.1) * b.1 / (c.1 - b.1)
    })
}

/// Increases from 0 to 1 between 0 and 1, with zero slope at both ends.
pub fn smooth_step(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

/// Integrates y' = `slope`(s, y) from `start` to `end` by the classical Runge–Kutta method of fourth order
/// in equal steps; returns y at all steps, the start included.
pub fn runge_kutta<const N: usize>(
    start: f64,
    end: f64,
    initial: [f64; N],
    steps: usize,
    slope: impl Fn(f64, &[f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let h = (end - start) / steps as f64;
    let moved = |y: &[f64; N], k: &[f64; N], factor: f64| -> [f64; N] {
        std::array::from_fn(|i| y[i] + factor * k[i])
    };
    let mut y = initial;
    let mut path = Vec::with_capacity(steps + 1);
    path.push(y);
    for step in 0..steps {
        let s = start + step as f64 * h;
        let k1 = slope(s, &y);
        let k2 = slope(s + 0.5 * h, &moved(&y, &k1, 0.5 * h));
        let k3 = slope(s + 0.5 * h, &moved(&y, &k2, 0.5 * h));
        let k4 = slope(s + h, &moved(&y, &k3, h));
        for i in 0..N {
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        path.push(y);
    }
    path
}

/// Nodes and weights of the Gauss–Legendre rule of `points` points on [0, 1].
pub fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            // Newton's method from Tricomi's approximation of the root of the Legendre polynomial.
            let mut x = libm::cos((i as f64 + 0.75) / (n + 0.5) * std::f64::consts::PI);
            let mut derivative = 0.0;
            for _ in 0..10 {
                let (mut previous, mut value) = (1.0, x);
                for k in 2..=points {
                    let k = k as f64;
                    let next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k;
                    previous = value;
                    value = next;
                }
                derivative = n * (previous - x * value) / (1.0 - x * x);
                x -= value / derivative;
            }
            let weight = 2.0 / ((1.0 - x * x) * derivative * derivative);
            (0.5 * (1.0 - x), 0.5 * weight)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_finds_the_last_bit() {
        let root = bisect(0.0, 3.0, |x| x * x - 2.0);
        assert!((root - 2f64.sqrt()).abs() <= f64::EPSILON);
    }

    /// Few evaluations where the function is smooth, no more than for bisection where it is not.
    #[test]
    fn zeros_are_found_in_few_evaluations() {
        let evaluations = |function: fn(f64) -> f64, zero: f64, width: f64| {
            let mut count = 0;
            let ends = [0.0, 3.0].map(|x| (x, function(x)));
            let found = find_zero(ends, width, |_, x| {
                count += 1;
                Ok::<_, ()>((x, function(x)))
            });
            assert!((found.unwrap() - zero).abs() <= width * zero, "{found:?}");
            count
        };
        assert!(evaluations(|x| x * x - 2.0, 2f64.sqrt(), 1e-12) <= 8);
        assert!(evaluations(|x| 1.0 - libm::exp(-40.0 * (x - 0.3)), 0.3, 1e-10) <= 20);
        assert!(evaluations(|x| (x - 0.7).powi(9), 0.7, 1e-6) <= 40);
        assert!(evaluations(|x| if x < 2.0 { 1.0 } else { -1e-3 }, 2.0, 1e-9) <= 40);
    }

    #[test]
    fn runge_kutta_is_of_fourth_order() {
        let error = |steps| {
            let end = *runge_kutta(0.0, 2.0, [1.0, 0.0], steps, |_, y| [-y[1], y[0]])
                .last()
                .unwrap();
            (end[0] - 2f64.cos()).hypot(end[1] - 2f64.sin())
        };
        let order = (error(40) / error(80)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn gauss_legendre_integrates_polynomials_exactly() {
        for points in [2, 5, 16] {
            for degree in 0..2 * points as i32 {
                let integral: f64 = gauss_legendre(points)
                    .iter()
                    .map(|(x, weight)| weight * x.powi(degree))
                    .sum();
                assert!((integral - 1.0 / f64::from(degree + 1)).abs() < 1e-14);
            }
        }
    }
}
