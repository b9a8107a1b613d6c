//! The Sobol' sequence: points that fill a cube more evenly than random ones.
//!
//! Direction numbers of Joe and Kuo, SIAM J. Sci. Comput. 30 (2008) 2635, table `new-joe-kuo-6`.

/// Bits of a coordinate.
const BITS: usize = 32;

/// Most coordinates.
pub const MOST_DIMENSIONS: usize = 10;

/// Coefficients of the primitive polynomials (inner bits) and the first odd numbers m, for the second
/// coordinate and those after it; the degree is the number of the latter.
const POLYNOMIALS: [(u32, &[u32]); MOST_DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
];

/// Coordinate `dimension` of point `index`, as 32 bits after the binary point.
pub fn coordinate(index: u32, dimension: usize) -> u32 {
    let directions = directions(dimension);
    let gray = index ^ (index >> 1);
    (0..BITS)
        .filter(|bit| gray >> bit & 1 == 1)
        .fold(0, |sum, bit| sum ^ directions[bit])
}

/// Direction numbers v of a coordinate.
fn directions(dimension: usize) -> [u32; BITS] {
    let mut directions = [0; BITS];
    let Some((coefficients, first)) = dimension.checked_sub(1).map(|next| POLYNOMIALS[next]) else {
        for (bit, direction) in directions.iter_mut().enumerate() {
            *direction = 1 << (BITS - 1 - bit);
        }
        return directions;
    };
    let degree = first.len();
    for bit in 0..BITS {
        directions[bit] = match first.get(bit) {
            Some(number) => number << (BITS - 1 - bit),
            None => {
                let oldest = directions[bit - degree];
                (1..degree)
                    .filter(|step| coefficients >> (degree - 1 - step) & 1 == 1)
                    .fold(oldest ^ (oldest >> degree), |sum, step| {
                        sum ^ directions[bit - step]
                    })
            }
        };
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_of_the_tables() {
        let point = |index| [0, 1, 2].map(|d| f64::from(coordinate(index, d)) / 2f64.powi(32));
        assert_eq!(point(0), [0.0; 3]);
        assert_eq!(point(1), [0.5; 3]);
        assert_eq!(point(2), [0.75, 0.25, 0.25]);
        assert_eq!(point(3), [0.25, 0.75, 0.75]);
        assert_eq!(point(4), [0.375, 0.375, 0.625]);
    }

    #[test]
    fn every_coordinate_visits_every_cell_once() {
        for dimension in 0..MOST_DIMENSIONS {
            let mut cells: Vec<u32> = (0..256).map(|k| coordinate(k, dimension) >> 24).collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..256), "{dimension}");
        }
    }

    #[test]
    fn two_coordinates_fill_every_elementary_rectangle() {
        for across in 0..=6 {
            let mut cells: Vec<u32> = (0..64)
                .map(|k| {
                    let [x, y] = [0, 1].map(|d| u64::from(coordinate(k, d)));
                    ((x >> (32 - across)) << (6 - across) | y >> (26 + across)) as u32
                })
                .collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..64), "{across}");
        }
    }
}
