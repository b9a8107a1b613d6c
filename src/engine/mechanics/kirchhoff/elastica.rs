//! Planar elasticas under a force and a uniform load, integrated from one end by Taylor series.
//!
//! With EI = 1, the force (H, V) at the start and the load w per length, at the inclination θ:
//!
//! > θ'' = H sin θ − (V + w s) cos θ,  x' = cos θ,  z' = sin θ

/// Number of coefficients of a series before truncation.
const TERMS: usize = 20;
/// Size of the last coefficients at which a step ends.
const ACCURACY: f64 = 1e-15;

type Series = [f64; TERMS + 2];

/// Horizontal and vertical force that an elastica exerts on the part before its start. For a sheet
/// that is lifted off a table, in EI/L_gb²:
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// H; negative: it pushes the resting part away from it.
    pub horizontal: f64,
    /// V; negative: it presses on the table.
    pub vertical: f64,
}

impl Forces {
    /// Interpolates to the fraction `part` between these and other forces; extrapolates outside of
    /// 0 to 1.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let between = |from: f64, to: f64| from + part * (to - from);
        Self {
            horizontal: between(self.horizontal, other.horizontal),
            vertical: between(self.vertical, other.vertical),
        }
    }
}

/// Load of an elastica.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastica {
    /// H and V.
    pub forces: Forces,
    /// w.
    pub load: f64,
}

/// A point of an elastica, with the derivatives of all quantities with respect to H and V.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// s.
    pub arc_length: f64,
    /// x, z, θ and θ'.
    pub state: State,
    /// Derivatives of the state by H.
    pub by_horizontal: State,
    /// Derivatives of the state by V.
    pub by_vertical: State,
}

/// Position, inclination and curvature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// x, along the horizontal.
    pub x: f64,
    /// z, up.
    pub z: f64,
    /// θ, the inclination.
    pub angle: f64,
    /// θ'.
    pub curvature: f64,
}

/// A part of an elastica between two arc lengths: θ as a power series, from which all else
/// follows.
#[derive(Debug)]
pub struct Piece {
    start: Place,
    /// θ, sin θ and cos θ.
    angle: Series,
    sine: Series,
    cosine: Series,
    /// Derivatives of θ, sin θ and cos θ with respect to H and V.
    tangents: [[Series; 3]; 2],
    /// Arc length up to which the error of the series is below `ACCURACY`.
    pub reach: f64,
}

impl Piece {
    /// The series at a place:
    ///
    /// > (k + 2)(k + 1) θ_{k+2} = H (sin θ)_k − (V + w s₀) (cos θ)_k − w (cos θ)_{k−1}
    /// > k (sin θ)_k = Σ_j j θ_j (cos θ)_{k−j},  k (cos θ)_k = −Σ_j j θ_j (sin θ)_{k−j}
    pub fn new(start: Place, elastica: Elastica) -> Self {
        let forces = elastica.forces;
        let vertical = elastica.vertical_at(start.arc_length);
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
        // j θ_j, and cos θ beside sin θ: the sums below are of pairs.
        let mut weighted = [0.0; TERMS + 2];
        let mut pairs = [[0.0; 2]; TERMS + 2];
        pairs[0] = [cosine[0], sine[0]];
        for k in 0..TERMS {
            if k > 0 {
                weighted[k] = k as f64 * angle[k];
                let [of_sine, of_cosine] = convolved(&weighted[1..=k], &pairs[..k]);
                (sine[k], cosine[k]) = (of_sine / k as f64, -(of_cosine / k as f64));
                pairs[k] = [cosine[k], sine[k]];
                for [angle_by, sine_by, cosine_by] in &mut tangents {
                    let [of_sine, of_cosine] = convolved(&angle_by[..=k], &pairs[..=k]);
                    (sine_by[k], cosine_by[k]) = (of_sine, -of_cosine);
                }
            }
            let before = |series: &Series| {
                if k > 0 {
                    elastica.load * series[k - 1]
                } else {
                    0.0
                }
            };
            let divisor = ((k + 1) * (k + 2)) as f64;
            angle[k + 2] =
                (forces.horizontal * sine[k] - vertical * cosine[k] - before(&cosine)) / divisor;
            let explicit = [sine[k], -cosine[k]];
            for ([angle_by, sine_by, cosine_by], explicit) in tangents.iter_mut().zip(explicit) {
                let implicit =
                    forces.horizontal * sine_by[k] - vertical * cosine_by[k] - before(cosine_by);
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

    /// The point at an arc length within reach.
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

/// Σ aⱼ b₋₁₋ⱼ over series of one length, the second one of pairs.
fn convolved(factors: &[f64], pairs: &[[f64; 2]]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (factor, pair) in factors.iter().zip(pairs.iter().rev()) {
        sums[0] += factor * pair[0];
        sums[1] += factor * pair[1];
    }
    sums
}

impl Elastica {
    /// An elastica under its weight, with lengths in L_gb and forces in EI/L_gb², so that its
    /// weight per length is 1/2.
    pub fn heavy(forces: Forces) -> Self {
        Self { forces, load: 0.5 }
    }

    /// V + w s.
    fn vertical_at(&self, arc_length: f64) -> f64 {
        self.forces.vertical + self.load * arc_length
    }

    /// Derivatives with respect to arc length at a point.
    pub fn slope(&self, place: &Place) -> State {
        let (sine, cosine) = libm::sincos(place.state.angle);
        State {
            x: cosine,
            z: sine,
            angle: place.state.curvature,
            curvature: self.forces.horizontal * sine - self.vertical_at(place.arc_length) * cosine,
        }
    }

    /// The point at the arc length `end` ≥ 0 of an elastica that begins at `start`.
    pub fn place_from(&self, start: Place, end: f64) -> Place {
        let mut place = start;
        while place.arc_length < end {
            let piece = Piece::new(place, *self);
            place = piece.at(piece.reach.min(end));
        }
        place
    }

    /// The point at the arc length `end` of an elastica that begins flat and without curvature.
    pub fn place(&self, end: f64) -> Place {
        self.place_from(Place::default(), end)
    }

    /// Points that divide such an elastica into equal parts of a length.
    pub fn places(&self, length: f64, parts: usize) -> Vec<Place> {
        let mut piece = Piece::new(Place::default(), *self);
        (0..=parts)
            .map(|part| {
                let arc_length = length * part as f64 / parts as f64;
                while piece.reach < arc_length {
                    piece = Piece::new(piece.at(piece.reach), *self);
                }
                piece.at(arc_length)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heavy(horizontal: f64, vertical: f64) -> Elastica {
        Elastica::heavy(Forces {
            horizontal,
            vertical,
        })
    }

    #[test]
    fn the_series_solve_the_equation() {
        let elastica = heavy(-0.5387, -1.9);
        let h = 1e-4;
        for s in [0.3, 1.7, 4.4] {
            let [before, here, after] = [s - h, s, s + h].map(|s| elastica.place(s).state);
            let second = (after.angle - 2.0 * here.angle + before.angle) / (h * h);
            let expected = -0.5387 * here.angle.sin() - (-1.9 + 0.5 * s) * here.angle.cos();
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
        let at = |horizontal, vertical| heavy(horizontal, vertical).place(5.0);
        let h = 1e-6;
        let exact = at(horizontal, vertical);
        let along = |length| heavy(horizontal, vertical).place(length);
        let by_length = heavy(horizontal, vertical).slope(&exact);
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
            (along(5.0 + h), along(5.0 - h), by_length),
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
        let elastica = heavy(-0.3, -1.1);
        for found in elastica.places(6.0, 17) {
            let alone = elastica.place(found.arc_length).state;
            assert!((alone.x - found.state.x).abs() < 1e-12);
            assert!((alone.z - found.state.z).abs() < 1e-12);
        }
    }
}
