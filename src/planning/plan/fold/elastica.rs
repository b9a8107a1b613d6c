//! The suspended part of a sheet from the touchdown point on, by Taylor series.

/// Coefficients of a series, the highest first to be left out.
const TERMS: usize = 20;
/// A step ends where the last coefficients reach this size.
const ACCURACY: f64 = 1e-15;

type Series = [f64; TERMS + 2];

/// Horizontal and vertical force that what is suspended exerts on the lying part, in EI/L_gb².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// H; negative: it pushes the lying part away.
    pub horizontal: f64,
    /// V; negative: it presses on the table.
    pub vertical: f64,
}

/// The sheet at an arc length from the touchdown point, lengths in L_gb, with the derivatives of all by H and by V.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// s.
    pub arc_length: f64,
    /// x, z, θ and θ'.
    pub state: State,
    /// Their derivatives by H.
    pub by_horizontal: State,
    /// Their derivatives by V.
    pub by_vertical: State,
}

/// Position, inclination and curvature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// x, along the lying part.
    pub x: f64,
    /// z, up.
    pub z: f64,
    /// θ, the inclination.
    pub angle: f64,
    /// θ'.
    pub curvature: f64,
}

/// The sheet between two arc lengths: θ as a power series, from which all else follows.
pub struct Piece {
    start: Place,
    /// θ, sin θ and cos θ.
    angle: Series,
    sine: Series,
    cosine: Series,
    /// Derivatives of θ, sin θ and cos θ by H and by V.
    tangents: [[Series; 3]; 2],
    /// Arc length up to which the series is as good as [`ACCURACY`].
    pub reach: f64,
}

impl Piece {
    /// The series of θ'' = H sin θ − (V + s/2) cos θ at a place:
    ///
    /// > (k + 2)(k + 1) θ_{k+2} = H (sin θ)_k − (V + s₀/2) (cos θ)_k − (cos θ)_{k−1}/2
    /// > k (sin θ)_k = Σ_j j θ_j (cos θ)_{k−j},  k (cos θ)_k = −Σ_j j θ_j (sin θ)_{k−j}
    pub fn new(start: Place, forces: Forces) -> Self {
        let load = forces.vertical + 0.5 * start.arc_length;
        let mut angle = [0.0; TERMS + 2];
        let [mut sine, mut cosine] = [[0.0; TERMS + 2]; 2];
        let mut tangents = [[[0.0; TERMS + 2]; 3]; 2];
        [angle[0], angle[1]] = [start.state.angle, start.state.curvature];
        (sine[0], cosine[0]) = libm::sincos(angle[0]);
        for (tangent, by) in tangents
            .iter_mut()
            .zip([start.by_horizontal, start.by_vertical])
        {
            let [angle, sine_by, cosine_by] = tangent;
            [angle[0], angle[1]] = [by.angle, by.curvature];
            sine_by[0] = cosine[0] * by.angle;
            cosine_by[0] = -sine[0] * by.angle;
        }
        for k in 0..TERMS {
            if k > 0 {
                let product = |factor: &Series| -> f64 {
                    let terms = (1..=k).map(|j| j as f64 * angle[j] * factor[k - j]);
                    terms.sum::<f64>() / k as f64
                };
                (sine[k], cosine[k]) = (product(&cosine), -product(&sine));
                for [angle_by, sine_by, cosine_by] in &mut tangents {
                    let product = |factor: &Series| -> f64 {
                        (0..=k).map(|j| angle_by[j] * factor[k - j]).sum()
                    };
                    (sine_by[k], cosine_by[k]) = (product(&cosine), -product(&sine));
                }
            }
            let before = |series: &Series| if k > 0 { 0.5 * series[k - 1] } else { 0.0 };
            let divisor = ((k + 1) * (k + 2)) as f64;
            angle[k + 2] =
                (forces.horizontal * sine[k] - load * cosine[k] - before(&cosine)) / divisor;
            let explicit = [sine[k], -cosine[k]];
            for ([angle_by, sine_by, cosine_by], explicit) in tangents.iter_mut().zip(explicit) {
                let implicit =
                    forces.horizontal * sine_by[k] - load * cosine_by[k] - before(cosine_by);
                angle_by[k + 2] = (explicit + implicit) / divisor;
            }
        }
        let last = |order: usize| libm::pow(ACCURACY / angle[order].abs(), 1.0 / order as f64);
        let reach = last(TERMS).min(last(TERMS + 1)).min(1.0);
        Self {
            start,
            angle,
            sine,
            cosine,
            tangents,
            reach: start.arc_length + reach,
        }
    }

    /// The place at an arc length within reach.
    pub fn at(&self, arc_length: f64) -> Place {
        let h = arc_length - self.start.arc_length;
        let value = |series: &Series| series.iter().rev().fold(0.0, |sum, term| sum * h + term);
        let slope = |series: &Series| {
            let terms = series.iter().enumerate().skip(1).rev();
            terms.fold(0.0, |sum, (k, term)| sum * h + k as f64 * term)
        };
        let integral = |series: &Series| {
            let terms = series[..TERMS].iter().enumerate().rev();
            h * terms.fold(0.0, |sum, (k, term)| sum * h + term / (k + 1) as f64)
        };
        let state = |start: &State, [angle, sine, cosine]: [&Series; 3]| State {
            x: start.x + integral(cosine),
            z: start.z + integral(sine),
            angle: value(angle),
            curvature: slope(angle),
        };
        let by = |start: &State, [angle, sine, cosine]: &[Series; 3]| {
            state(start, [angle, sine, cosine])
        };
        Place {
            arc_length,
            state: state(&self.start.state, [&self.angle, &self.sine, &self.cosine]),
            by_horizontal: by(&self.start.by_horizontal, &self.tangents[0]),
            by_vertical: by(&self.start.by_vertical, &self.tangents[1]),
        }
    }
}

/// The sheet at arc length `end` ≥ 0 from the touchdown point, where it is flat and has no curvature.
pub fn place(forces: Forces, end: f64) -> Place {
    let mut place = Place::default();
    while place.arc_length < end {
        let piece = Piece::new(place, forces);
        place = piece.at(piece.reach.min(end));
    }
    place
}

/// The sheet at `parts` + 1 places that divide its suspended length equally.
pub fn places(forces: Forces, length: f64, parts: usize) -> Vec<Place> {
    let mut piece = Piece::new(Place::default(), forces);
    (0..=parts)
        .map(|part| {
            let arc_length = length * part as f64 / parts as f64;
            while piece.reach < arc_length {
                piece = Piece::new(piece.at(piece.reach), forces);
            }
            piece.at(arc_length)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_solve_the_equation() {
        let forces = Forces {
            horizontal: -0.5387,
            vertical: -1.9,
        };
        let h = 1e-4;
        for s in [0.3, 1.7, 4.4] {
            let [before, here, after] = [s - h, s, s + h].map(|s| place(forces, s).state);
            let second = (after.angle - 2.0 * here.angle + before.angle) / (h * h);
            let load = forces.vertical + 0.5 * s;
            let expected = forces.horizontal * here.angle.sin() - load * here.angle.cos();
            assert!((second - expected).abs() < 1e-6, "{second} {expected}");
            let slope = (after.angle - before.angle) / (2.0 * h);
            assert!((slope - here.curvature).abs() < 1e-7);
            assert!(((after.x - before.x) / (2.0 * h) - here.angle.cos()).abs() < 1e-7);
            assert!(((after.z - before.z) / (2.0 * h) - here.angle.sin()).abs() < 1e-7);
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let [horizontal, vertical] = [0.7, -1.3];
        let at = |horizontal, vertical| {
            let forces = Forces {
                horizontal,
                vertical,
            };
            place(forces, 5.0)
        };
        let h = 1e-6;
        let exact = at(horizontal, vertical);
        let parts = |state: State| [state.x, state.z, state.angle, state.curvature];
        let pairs = [
            (
                at(horizontal + h, vertical),
                at(horizontal - h, vertical),
                exact.by_horizontal,
            ),
            (
                at(horizontal, vertical + h),
                at(horizontal, vertical - h),
                exact.by_vertical,
            ),
        ];
        for (after, before, by) in pairs {
            for ((after, before), by) in parts(after.state)
                .into_iter()
                .zip(parts(before.state))
                .zip(parts(by))
            {
                let difference = (after - before) / (2.0 * h);
                assert!(
                    (difference - by).abs() < 1e-6 * (1.0 + by.abs()),
                    "{difference} {by}"
                );
            }
        }
    }

    #[test]
    fn places_are_those_found_one_by_one() {
        let forces = Forces {
            horizontal: -0.3,
            vertical: -1.1,
        };
        for found in places(forces, 6.0, 17) {
            let alone = place(forces, found.arc_length).state;
            assert!((alone.x - found.state.x).abs() < 1e-12);
            assert!((alone.z - found.state.z).abs() < 1e-12);
        }
    }
}
