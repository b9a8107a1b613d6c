//! A lead-in before a pattern, over which the curvature grows from zero.

use super::{PatternPoint, Point};
use rodlab_engine::mechanics::kirchhoff::numerics::gauss_legendre;

/// Number of Gauss points for positions along the lead-in.
const QUADRATURE: usize = 40;

/// The lead-in begins with a straight part. Then κ is the polynomial of degree five that vanishes
/// with two derivatives at its start, and matches the pattern at its end in value and two
/// derivatives.
#[derive(Clone, Debug)]
pub struct LeadIn {
    /// Length of the straight part, m.
    straight: f64,
    /// Length over which the curvature grows, m.
    bent: f64,
    /// Start of the pattern.
    end: PatternPoint,
    /// Coefficients of (σ/ℓ)³, (σ/ℓ)⁴ and (σ/ℓ)⁵.
    coefficients: [f64; 3],
    rule: Vec<(f64, f64)>,
}

/// Number of points at which the curvature of a lead-in is sampled.
const LOOKS: u32 = 200;

/// Curvature measures of a lead-in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadBend {
    /// Largest curvature, 1/m.
    pub sharpest: f64,
    /// Total rotation of the tangent, counting both senses, rad.
    pub turn: f64,
}

impl LeadBend {
    /// The measures of the lead-in with a given length, m, to a point. For a lead-out, use the
    /// reversed point.
    pub fn of(end: &PatternPoint, bent: f64) -> Self {
        let lead = LeadIn::new(end, 0.0, bent);
        let [c3, c4, c5] = lead.coefficients;
        let curvatures = (1..=LOOKS).map(|k| {
            let x = f64::from(k) / f64::from(LOOKS);
            (x.powi(3) * (c3 + x * (c4 + x * c5))).abs()
        });
        let (sharpest, sum) = curvatures.fold((0.0_f64, 0.0), |(most, sum), curvature| {
            (most.max(curvature), sum + curvature)
        });
        Self {
            sharpest,
            turn: sum * bent / f64::from(LOOKS),
        }
    }
}

impl LeadIn {
    pub fn new(end: &PatternPoint, straight: f64, bent: f64) -> Self {
        // Coefficients of c₃x³ + c₄x⁴ + c₅x⁵ with the value a, slope b and second derivative c at
        // x = 1.
        let a = end.curvature;
        let b = end.curvature_slope * bent;
        let c = end.curvature_bend * bent * bent;
        Self {
            straight,
            bent,
            end: *end,
            coefficients: [
                10.0 * a - 4.0 * b + 0.5 * c,
                -15.0 * a + 7.0 * b - c,
                6.0 * a - 3.0 * b + 0.5 * c,
            ],
            rule: gauss_legendre(QUADRATURE),
        }
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.straight + self.bent
    }

    /// Direction of the tangent at the length s of the bent part.
    fn angle(&self, s: f64) -> f64 {
        let x = s / self.bent;
        let [c3, c4, c5] = self.coefficients;
        let turned = |x: f64| x.powi(4) * (c3 / 4.0 + x * (c4 / 5.0 + x * c5 / 6.0));
        self.end.angle - self.bent * (turned(1.0) - turned(x))
    }

    pub fn at(&self, s: f64) -> PatternPoint {
        let bent = s - self.straight;
        if bent > 0.0 {
            return PatternPoint {
                s,
                ..self.at_bent(bent)
            };
        }
        let corner = if self.bent > 0.0 {
            self.at_bent(0.0)
        } else {
            self.end
        };
        let (sine, cosine) = libm::sincos(corner.angle);
        PatternPoint {
            s,
            position: corner.position + bent * Point::new(cosine, sine),
            angle: corner.angle,
            curvature: 0.0,
            curvature_slope: 0.0,
            curvature_bend: 0.0,
        }
    }

    /// The point at the length s of the bent part.
    fn at_bent(&self, s: f64) -> PatternPoint {
        let rest = self.bent - s;
        let mut way = Point::zeros();
        for (part, weight) in &self.rule {
            let angle = self.angle(s + rest * part);
            way += rest * *weight * Point::new(libm::cos(angle), libm::sin(angle));
        }
        let x = s / self.bent;
        let [c3, c4, c5] = self.coefficients;
        PatternPoint {
            s,
            position: self.end.position - way,
            angle: self.angle(s),
            curvature: x.powi(3) * (c3 + x * (c4 + x * c5)),
            curvature_slope: x.powi(2) * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)) / self.bent,
            curvature_bend: x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))
                / (self.bent * self.bent),
        }
    }
}
