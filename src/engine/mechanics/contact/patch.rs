//! A triangle of a mesh that stands for a smooth surface, as a curved patch.
//!
//! The triangle has the corners p_i and the unit normals n_i there. Every point x near it has
//! coordinates b_i, Σ b_i = 1, and t with
//!
//! x = P(b) + t N(b),   P = Σ b_i p_i,   N = Σ b_i n_i,
//!
//! so that x lies in the triangle of the points p_i + t n_i, with the weights b. The coordinates of
//! two triangles agree along a common side, and each point near the mesh lies over one triangle,
//! with b ≥ 0. The height of x over the patch is
//!
//! ```text
//! g = t ν − S/(1 + ν) + C,   ν = ‖N‖,
//! S = Σ_{i<j} b_i b_j [(n_j − n_i)·(p_j − p_i) + (b_i − b_j)(n_i + n_j)·(p_i − p_j)].
//! ```
//!
//! Without C its gradient at a corner is the normal there, and along a side g depends on the side
//! alone, so that it is continuous. With p_i = R n_i it is (t + R) ν − R: the exact distance for
//! spheres, as well as for cylinders and planes. The correction C makes the gradient continuous. On
//! a side with e = p_j − p_i + t (n_j − n_i), the gradient shall lie in the plane of e and N, which
//! two triangles share. Towards the opposite corner k, with X = ∂x/∂b_k, the slope of g must then be
//! that along the projection of X onto this plane; let c_k be what is missing. With weights that are
//! 1 on one side and 0 on the others (Nielson 1979),
//!
//! C = Σ_k b_k c_k (b_i b_j)²/Σ (b_i b_j)².
//!
//! It vanishes where the surface is a quadric to the accuracy of the triangle. The error of the
//! height is of third order in the size of triangles, that of the gradient of second order; on the
//! flat triangles both are an order lower.
//!
//! All derivatives are exact: those of g by its coordinates are found by [`super::jet`], and with y = (b₁, b₂, t) and M = ∂x/∂y = (e₁, e₂, N), e_k = p_k − p_0 + t
//! d_k, d_k = n_k − n_0, the rows of M⁻¹ are ∇y, and
//!
//! ∇g = Σ g_a ∇y_a,   ∇∇g = Σ g_ab ∇y_a ∇y_bᵀ − Σ_k (∇g·d_k)(∇t ∇b_kᵀ + ∇b_k ∇tᵀ).

use super::contacts::Linearised;
use super::edge_contact::Sliding;
use super::jet::Jet;
use super::normal_response::NormalResponse;
use crate::mechanics::{Matrix3, Vector3};

/// Maximum number of Newton's iterations for the coordinates; they take three or four.
const ITERATIONS: usize = 12;
/// Relative change of the coordinates at which the iterations end: its square is negligible.
const CONVERGED: f64 = 1e-8;
/// Weight of a corner below which a point is so far beside the triangle that its coordinates there
/// are not needed.
const FAR_BESIDE: f64 = -1.0;

/// The corners of each side, and the opposite corner.
const SIDES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
/// Sum of the squared products of two weights below which a point is at a corner, where the
/// correction vanishes.
const AT_CORNER: f64 = 1e-28;

/// A curved triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Corners p, m.
    pub corners: [Vector3; 3],
    /// Unit normals n at the corners.
    pub normals: [Vector3; 3],
}

/// Coordinates of a point over a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coordinates {
    /// b.
    pub weights: [f64; 3],
    /// t, m.
    height: f64,
    /// ∇b₁, ∇b₂ (1/m) and ∇t.
    gradients: [Vector3; 3],
}

/// A point and its foot on a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PatchPoint {
    /// Index of the face.
    pub face: usize,
    /// Coordinates over it.
    pub at: Coordinates,
    /// Height g on the side of the point, m.
    pub distance: f64,
    /// ∇g on this side. Its length is 1 on spheres and cylinders, and near 1 elsewhere.
    pub normal: Vector3,
    /// The surface is at P + sN with this s, m.
    pub surface_height: f64,
}

/// How the foot of a point moves with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PatchBend {
    /// ∇∇g on the side of the point, 1/m.
    pub turning: Matrix3,
    /// ∇b, 1/m.
    pub weight_gradients: [Vector3; 3],
}

impl PatchBend {
    /// The same without any motion.
    pub(crate) fn none() -> Self {
        Self {
            turning: Matrix3::zeros(),
            weight_gradients: [Vector3::zeros(); 3],
        }
    }
}

impl Patch {
    /// P + tN for given coordinates, and N.
    fn at(&self, [b, c]: [f64; 2], height: f64) -> (Vector3, Vector3) {
        let ([p0, p1, p2], [n0, n1, n2]) = (&self.corners, &self.normals);
        let a = 1.0 - b - c;
        let normal = n0 * a + n1 * b + n2 * c;
        (p0 * a + p1 * b + p2 * c + normal * height, normal)
    }

    /// Coordinates of a point.
    ///
    /// # Errors
    /// The weights of the foot in the plane of the triangle, for a point that is far beside the
    /// triangle, or so far in front of a concave patch or behind a convex one that it has no
    /// coordinates.
    pub(crate) fn coordinates(&self, point: &Vector3) -> Result<Coordinates, [f64; 3]> {
        let ([p0, p1, p2], [n0, n1, n2]) = (&self.corners, &self.normals);
        let (sides, turns) = ([p1 - p0, p2 - p0], [n1 - n0, n2 - n0]);
        // The coordinates are then linear, and the first iteration is exact.
        let is_flat = turns == [Vector3::zeros(); 2];
        let mut weights = [1.0 / 3.0; 2];
        let mut height = 0.0;
        let mut flat = None;
        for _ in 0..ITERATIONS {
            let (there, normal) = self.at(weights, height);
            let Some(gradients) = inverse(&sides, &turns, &normal, height) else {
                break;
            };
            let missing = point - there;
            let [b, c, t] = gradients.map(|row| row.dot(&missing));
            weights = [weights[0] + b, weights[1] + c];
            height += t;
            let all = [1.0 - weights[0] - weights[1], weights[0], weights[1]];
            flat.get_or_insert(all);
            if all.iter().any(|weight| *weight < FAR_BESIDE) {
                break;
            }
            if is_flat {
                return Ok(Coordinates {
                    weights: all,
                    height,
                    gradients,
                });
            }
            let size = height.abs() + sides[0].norm();
            if b.abs().max(c.abs()) < CONVERGED && t.abs() < CONVERGED * size {
                let (_, normal) = self.at(weights, height);
                let Some(gradients) = inverse(&sides, &turns, &normal, height) else {
                    break;
                };
                return Ok(Coordinates {
                    weights: all,
                    height,
                    gradients,
                });
            }
        }
        Err(flat.unwrap_or([1.0 / 3.0; 3]))
    }

    /// The foot of a point with these coordinates on the patch of a face, seen from a `side`, 1 or
    /// −1.
    pub(crate) fn foot(&self, face: usize, at: &Coordinates, side: f64) -> PatchPoint {
        let (height, surface_height) = self.height::<0, 0, 0>(at);
        PatchPoint {
            face,
            at: *at,
            distance: height.value * side,
            normal: along(&at.gradients, &height.slopes) * side,
            surface_height,
        }
    }

    /// How the foot moves with a point with these coordinates.
    pub(crate) fn bend(&self, at: &Coordinates, side: f64) -> PatchBend {
        let (height, _) = self.height::<1, 2, 3>(at);
        let [y1, y2, yt] = at.gradients;
        let (normal, bent) = (along(&at.gradients, &height.slopes), height.curvatures);
        let [n0, n1, n2] = &self.normals;
        let both = |a: &Vector3, b: &Vector3| {
            let product = a * b.transpose();
            product + product.transpose()
        };
        let turning = y1 * y1.transpose() * bent[0][0]
            + y2 * y2.transpose() * bent[1][1]
            + yt * yt.transpose() * bent[2][2]
            + both(&y1, &y2) * bent[0][1]
            + both(&yt, &y1) * (bent[0][2] - normal.dot(&(n1 - n0)))
            + both(&yt, &y2) * (bent[1][2] - normal.dot(&(n2 - n0)));
        PatchBend {
            turning: turning * side,
            weight_gradients: [-(y1 + y2), y1, y2],
        }
    }

    /// g as a function of the weights of the second and third corner and of t, and the t at which
    /// it is zero for the same weights, to the order of the correction. L, M and N are 0 for first
    /// derivatives, or 1, 2 and 3 for second ones, too.
    fn height<const L: usize, const M: usize, const N: usize>(
        &self,
        at: &Coordinates,
    ) -> (Jet<3, N>, f64) {
        let [_, b, c] = at.weights;
        let [b, c, t] = [(0, b), (1, c), (2, at.height)].map(|(k, value)| Jet::variable(k, value));
        let weights = [-b - c + 1.0, b, c];
        let products = SIDES.map(|[i, j, _]| weights[i] * weights[j]);
        let sides = SIDES.map(|corners| Side::of(self, corners));
        let (mut square, mut sum) = (Jet::constant(1.0), Jet::constant(0.0));
        for ((side, product), [i, j, _]) in sides.iter().zip(products).zip(SIDES) {
            square = square - product * side.turn;
            let bend = (weights[i] - weights[j]) * side.skew + side.bend;
            sum = sum + product * bend;
        }
        let length = square.sqrt();
        let bulge = sum * (length + 1.0).recip();
        let mut height = t * length - bulge;
        let surface_height = bulge.value / length.value;
        let shares = products.map(Jet::square);
        let all = shares[0] + shares[1] + shares[2];
        let is_flat = sides.iter().all(|side| side.turn == 0.0);
        if all.value > AT_CORNER && !is_flat {
            let inverse = all.recip();
            for (m, (share, [i, j, k])) in shares.into_iter().zip(SIDES).enumerate() {
                let along = weights[i] + weights[j];
                // Such weights belong to the opposite corner, where the share is far smaller.
                if along.value > AT_CORNER.sqrt() {
                    let place = weights[j] * along.recip();
                    let others = [&sides[(m + 2) % 3], &sides[(m + 1) % 3]];
                    let excess = sides[m].excess::<L, M>(others, place.value, t.value);
                    let excess = excess.at(&place);
                    height = height + weights[k] * share * inverse * excess;
                }
            }
        }
        (height, surface_height)
    }
}

/// Products from which the height over a side from the corner i to j follows, with the opposite corner
/// k.
struct Side {
    /// p_j − p_i and n_j − n_i: their squares and product.
    length: f64,
    turn: f64,
    bend: f64,
    /// (n_i + n_j)·(p_i − p_j).
    skew: f64,
    /// Products of e = p_j − p_i and d = n_j − n_i with p_k − p_i, n_k − n_i and n_i.
    along_p: [f64; 2],
    along_n: [f64; 2],
    along_first: [f64; 2],
    /// n_i·(p_k − p_i) and n_i·n_k.
    across: [f64; 2],
}

impl Side {
    fn of(patch: &Patch, [i, j, k]: [usize; 3]) -> Self {
        let (p, n) = (&patch.corners, &patch.normals);
        let (e, d) = (p[j] - p[i], n[j] - n[i]);
        let both = |vector: Vector3| [e.dot(&vector), d.dot(&vector)];
        Self {
            length: e.norm_squared(),
            turn: d.norm_squared(),
            bend: e.dot(&d),
            skew: -(n[i] + n[j]).dot(&e),
            along_p: both(p[k] - p[i]),
            along_n: both(n[k] - n[i]),
            along_first: both(n[i]),
            across: [n[i].dot(&(p[k] - p[i])), n[i].dot(&n[k])],
        }
    }

    /// The slope of the height towards the opposite corner that is missing for a gradient in the
    /// plane of side and normal, as a function of the part s of the side and of t; `before` and
    /// `after` are the sides from k to i and from j to k.
    fn excess<const L: usize, const M: usize>(
        &self,
        [before, after]: [&Self; 2],
        s: f64,
        t: f64,
    ) -> Jet<2, M> {
        let none = Jet::constant(0.0);
        let s = Jet::<1, L>::variable(0, s);
        let rest = -s + 1.0;
        let product = s * rest;
        let odd = rest - s;
        // ν, S and 1/(1 + ν) on the side, with their slopes along it, by s, and towards k, by r.
        let square = product * -self.turn + 1.0;
        let length = square.sqrt();
        let inverse = length.recip();
        let part = (length + 1.0).recip();
        let sum = product * (odd * self.skew + self.bend);
        let sum_by_s = odd * self.bend + (odd.square() - product * 2.0) * self.skew;
        let sum_by_r = rest * (rest * -before.skew + before.bend)
            + s * (s * after.skew + after.bend)
            - product * (odd * (3.0 * self.skew) + 2.0 * self.bend);
        // N·n_k − ν², with N = n_i + s d.
        let [turn_n, first_n] = [self.along_n[1] + self.along_first[1], self.across[1]];
        let to_corner = s * turn_n + first_n - square;
        let slope = |of_length: Jet<1, L>, of_sum: Jet<1, L>| -> Jet<2, M> {
            let bulge = (of_sum - sum * part * of_length) * part;
            Jet::quadratic([-bulge, of_length, none], t)
        };
        let by_s = slope(odd * inverse * (-0.5 * self.turn), sum_by_s);
        let by_r = slope(to_corner * inverse, sum_by_r);
        // Products of E = e + t d, N, and X = p_k − p_i − s e + t (n_k − N).
        let ([e_first, d_first], [e_p, d_p]) = (self.along_first, self.along_p);
        let ([e_n, d_n], constant) = (self.along_n, Jet::constant);
        let (ee, ed, dd) = (self.length, self.bend, self.turn);
        let of_t = |coefficients| -> Jet<2, M> { Jet::quadratic(coefficients, t) };
        let normal_normal = of_t([square, none, none]);
        let side_side = of_t([constant(ee), constant(2.0 * ed), constant(dd)]);
        let side_normal = of_t([s * ed + e_first, s * dd + d_first, none]);
        let side_corner = of_t([s * -ee + e_p, s * (-2.0 * ed) + (d_p + e_n), s * -dd + d_n]);
        let foot = s * (s * -ed + (d_p - e_first)) + self.across[0];
        let normal_corner = of_t([foot, to_corner, none]);
        let determinant = side_side * normal_normal - side_normal.square();
        let along_side = side_corner * normal_normal - normal_corner * side_normal;
        let along_normal = side_side * normal_corner - side_normal * side_corner;
        let wanted = along_side * by_s + along_normal * of_t([length, none, none]);
        wanted * determinant.recip() - by_r
    }
}

/// The sum of three vectors with weights.
fn along(vectors: &[Vector3; 3], weights: &[f64; 3]) -> Vector3 {
    vectors[0] * weights[0] + vectors[1] * weights[1] + vectors[2] * weights[2]
}

/// The rows of M⁻¹; `None` if the patch is folded at this height.
fn inverse(
    sides: &[Vector3; 2],
    turns: &[Vector3; 2],
    normal: &Vector3,
    height: f64,
) -> Option<[Vector3; 3]> {
    let [e1, e2] = [0, 1].map(|k| sides[k] + turns[k] * height);
    let area = e1.cross(&e2);
    let determinant = area.dot(normal);
    (determinant > 0.0)
        .then(|| [e2.cross(normal), normal.cross(&e1), area].map(|row| row / determinant))
}

impl PatchPoint {
    /// Weights of the node and the corners in the motion at the contact.
    pub(crate) fn all_weights(&self) -> [f64; 4] {
        let [a, b, c] = self.at.weights;
        [1.0, -a, -b, -c]
    }

    /// ∂(n/‖n‖) with respect to the coordinates of the node and the corners, which are at rest, 1/m.
    pub(crate) fn unit_normal_jacobian(&self, bend: &PatchBend) -> [[f64; 12]; 3] {
        let length = self.normal.norm();
        let normal = self.normal / length;
        let turning = (bend.turning - normal * (normal.transpose() * bend.turning)) / length;
        over_first_node(&turning)
    }
}

impl PatchBend {
    /// Derivatives of the weights of the node and the corners with respect to the node, 1/m.
    pub(crate) fn weight_rates(&self) -> [[f64; 12]; 4] {
        let mut rates = [[0.0; 12]; 4];
        for (rate, gradient) in rates[1..].iter_mut().zip(&self.weight_gradients) {
            rate[..3].copy_from_slice((-gradient).as_slice());
        }
        rates
    }

    /// ∂n with respect to the coordinates of the node and the corners, which are at rest, 1/m.
    pub(crate) fn normal_jacobian(&self) -> [[f64; 12]; 3] {
        over_first_node(&self.turning)
    }
}

/// A derivative with respect to the first of four nodes, padded to all of them.
fn over_first_node(of_node: &Matrix3) -> [[f64; 12]; 3] {
    let entry = |row, column| {
        if column < 3 {
            of_node[(row, column)]
        } else {
            0.0
        }
    };
    std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)))
}

/// Derivative of the force N (n + ‖n‖ t) of a patch on a node, N/m, for the friction law linearised
/// at the slip given with `sliding` (m/s). Normal and contact point move as given by `bend`. Where
/// the surface itself moves, the change of its velocity along the normals is neglected.
pub(super) fn patch_jacobian(
    point: &PatchPoint,
    response: &NormalResponse,
    sliding: Option<(&Sliding, Vector3)>,
    bend: &PatchBend,
) -> Linearised<[[f64; 3]; 3]> {
    let (normal, turning) = (&point.normal, bend.turning);
    let (mut direction, mut direction_jacobian) = (*normal, turning);
    let mut traction_gradient = [[0.0; 12]; 3];
    if let Some((sliding, at)) = sliding {
        let velocity = sliding.relative_velocity(&point.all_weights());
        let traction = sliding.traction_derivatives(normal, velocity, &at);
        let mut by_position = Matrix3::identity() / sliding.time_step;
        let corners = sliding.velocities[1..].iter().zip(&bend.weight_gradients);
        for (velocity, gradient) in corners {
            by_position -= velocity * gradient.transpose();
        }
        let length = normal.norm();
        let stretch = normal.transpose() * turning / length;
        let across = turning - normal * stretch / length;
        let rates = traction.by_velocity * by_position + traction.by_normal * across;
        direction += traction.value * length;
        direction_jacobian += rates * length + traction.value * stretch;
        for (row, gradient) in traction_gradient.iter_mut().enumerate() {
            for column in 0..3 {
                gradient[column] = rates[(row, column)];
            }
        }
    }
    let jacobian =
        direction * normal.transpose() * response.force_slope + direction_jacobian * response.force;
    let mut gap_gradient = [0.0; 12];
    gap_gradient[..3].copy_from_slice(normal.as_slice());
    Linearised {
        jacobian: std::array::from_fn(|row| std::array::from_fn(|column| jacobian[(row, column)])),
        gap_gradient,
        traction_gradient,
    }
}

#[cfg(test)]
#[path = "patch_tests.rs"]
mod tests;
