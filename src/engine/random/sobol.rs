//! Sobol' points: a sequence that fills the unit cube increasingly evenly (Sobol' 1967), with the
//! direction numbers of Joe and Kuo (2008), in the order of Antonov and Saleev's Gray code.

/// Most dimensions.
pub const MOST_DIMENSIONS: usize = 10;
/// Most points, since the numbers have 32 bits.
pub const MOST_POINTS: u64 = 1 << 32;

/// Degree and coefficients of the primitive polynomial of a dimension, and its first direction numbers; the first dimension
/// needs none.
const POLYNOMIALS: [(u32, u32, &[u32]); MOST_DIMENSIONS - 1] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
];

/// The point with a number, from 0; each coordinate is in [0, 1).
///
/// # Panics
/// Panics for more than [`MOST_DIMENSIONS`], or for a number of at least [`MOST_POINTS`].
pub fn sobol<const DIMENSIONS: usize>(number: u64) -> [f64; DIMENSIONS] {
    let number = u32::try_from(number).expect("a number below MOST_POINTS");
    std::array::from_fn(|dimension| {
        f64::from(sobol_coordinate(number, dimension)) / MOST_POINTS as f64
    })
}

/// A coordinate of the point with a number, as 32 bits after the binary point.
///
/// # Panics
/// Panics if the dimension is [`MOST_DIMENSIONS`] or more.
pub fn sobol_coordinate(number: u32, dimension: usize) -> u32 {
    let gray = number ^ (number >> 1);
    let directions = directions(dimension);
    let bits = (0..32).filter(|bit| gray >> bit & 1 == 1);
    bits.fold(0, |sum, bit| sum ^ directions[bit])
}

/// Direction numbers of a dimension, as binary fractions.
fn directions(dimension: usize) -> [u32; 32] {
    let mut v = std::array::from_fn(|bit| 1 << (31 - bit));
    let Some(polynomial) = dimension.checked_sub(1) else {
        return v;
    };
    let (degree, coefficients, first) = POLYNOMIALS[polynomial];
    let degree = degree as usize;
    for (bit, m) in first.iter().enumerate() {
        v[bit] = m << (31 - bit);
    }
    for bit in degree..32 {
        v[bit] = v[bit - degree] ^ (v[bit - degree] >> degree);
        for k in 1..degree {
            if coefficients >> (degree - 1 - k) & 1 == 1 {
                v[bit] ^= v[bit - k];
            }
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_of_the_tables() {
        let points: Vec<[f64; 3]> = (0..5).map(sobol).collect();
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
        ];
        assert_eq!(points, expected);
    }

    /// A (t, m, s) net with t = 0 for each coordinate: each of 2^m intervals holds one of the first 2^m points.
    #[test]
    fn each_coordinate_alone_is_evenly_spread() {
        let points: Vec<[f64; 10]> = (0..1024).map(sobol).collect();
        for dimension in 0..10 {
            let mut seen = [false; 1024];
            for point in &points {
                seen[(point[dimension] * 1024.0) as usize] = true;
            }
            assert!(seen.iter().all(|seen| *seen), "{dimension}");
        }
    }

    #[test]
    fn two_coordinates_fill_every_elementary_rectangle() {
        for across in 0..=6 {
            let mut cells: Vec<u32> = (0..64)
                .map(|number| {
                    let [x, y] = [0, 1].map(|d| u64::from(sobol_coordinate(number, d)));
                    ((x >> (32 - across)) << (6 - across) | y >> (26 + across)) as u32
                })
                .collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..64), "{across}");
        }
    }

    /// Integrals converge nearly like 1/n.
    #[test]
    fn means_of_a_smooth_function_converge_faster_than_by_chance() {
        let error = |count: u64| {
            let product = |point: [f64; 6]| point.iter().map(|x| 2.0 * x).product::<f64>();
            (0..count).map(|number| product(sobol(number))).sum::<f64>() / count as f64 - 1.0
        };
        let [coarse, fine] = [error(1 << 8), error(1 << 14)].map(f64::abs);
        assert!(fine < coarse / 20.0 && fine < 1e-3, "{coarse} {fine}");
    }
}
