//! Strains, gradient and Hessian of [`LANES`] vertices at a time: the formulas of [`super::vertex`] lane by lane.

use super::discretization::Vertex;
use super::frame_lanes::{FrameLanes, VectorLanes, every_lane, set_vector, shift, vector};
use super::transport::parallel_transport;
use super::trigonometry::angle_of;
use super::turning_angle::AngleRatio;
use super::vertex::{self, EdgeFrame, Moments, VertexGradient, VertexStiffness, VertexStrains};
use super::vertex_hessian::{self, VertexHessian};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Unknowns (x₋, θ⁰, x, θ¹, x₊) of a vertex.
pub(crate) const VERTEX_UNKNOWNS: usize = 11;

/// Strains, structure of arrays; meaning and units as in [`VertexStrains`].
#[derive(Clone, Debug)]
#[repr(align(64))]
struct StrainLanes {
    curvature: [Lanes; 4],
    twist: Lanes,
}

impl StrainLanes {
    fn new() -> Self {
        Self {
            curvature: [[0.0; LANES]; 4],
            twist: [0.0; LANES],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, strains: &VertexStrains) {
        for k in 0..4 {
            self.curvature[k][lane] = strains.curvature[k];
        }
        self.twist[lane] = strains.twist;
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> VertexStrains {
        let c = &self.curvature;
        VertexStrains {
            curvature: [c[0][lane], c[1][lane], c[2][lane], c[3][lane]],
            twist: self.twist[lane],
        }
    }
}

/// Strains, natural strains and stiffness of up to [`LANES`] vertices, structure of arrays.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct SectionLanes {
    strains: StrainLanes,
    natural: StrainLanes,
    bending: [Lanes; 2],
    twisting: Lanes,
    /// Whether the strain of each lane is the turning angle (1) or the curvature binormal (0).
    angle: Lanes,
    has_angles: bool,
}

/// Whether any of these vertices, which share lanes, bends by the turning angle.
pub(super) fn have_angles(vertices: &[Vertex]) -> bool {
    vertices.iter().any(|vertex| vertex.strain.share() > 0.0)
}

/// The frames of the edges before and after the vertices.
pub(super) type Beside<'a> = [&'a FrameLanes; 2];

impl SectionLanes {
    /// Straight rods without stiffness. With `has_angles` the derivatives of every lane allow for
    /// turning angles.
    pub(crate) fn new(has_angles: bool) -> Self {
        Self {
            strains: StrainLanes::new(),
            natural: StrainLanes::new(),
            bending: [[0.0; LANES]; 2],
            twisting: [0.0; LANES],
            angle: [0.0; LANES],
            has_angles,
        }
    }

    /// Copies the natural strains and stiffnesses of a vertex to a lane.
    fn take_natural_strains(&mut self, lane: usize, vertex: &Vertex) {
        self.natural.set(lane, &vertex.natural);
        self.bending[0][lane] = vertex.stiffness.bending[0];
        self.bending[1][lane] = vertex.stiffness.bending[1];
        self.twisting[lane] = vertex.stiffness.twisting;
    }

    /// Copies the natural strains and stiffnesses of a vertex from the lane `from` of `others`.
    pub(crate) fn take_lane(&mut self, lane: usize, others: &Self, from: usize) {
        self.natural.set(lane, &others.natural.get(from));
        self.bending[0][lane] = others.bending[0][from];
        self.bending[1][lane] = others.bending[1][from];
        self.twisting[lane] = others.twisting[from];
        self.angle[lane] = others.angle[from];
    }

    /// Puts a vertex into a lane.
    pub(crate) fn set(&mut self, lane: usize, vertex: &Vertex) {
        self.take_natural_strains(lane, vertex);
        self.angle[lane] = vertex.strain.share();
    }

    /// Computes the curvatures of every lane, and the angle between the reference directors of its
    /// edges.
    pub(crate) fn bend(
        &mut self,
        set: InstructionSet,
        beside: Beside,
        reference: [&VectorLanes; 2],
    ) -> Lanes {
        let mut angle = [0.0; LANES];
        bend(
            set,
            beside,
            reference,
            &mut self.strains.curvature,
            &mut angle,
        );
        angle
    }

    /// The twists of all lanes, rad, for setting them.
    pub(crate) fn twists_mut(&mut self) -> &mut Lanes {
        &mut self.strains.twist
    }

    /// Strains of a lane.
    pub(crate) fn strains(&self, lane: usize) -> VertexStrains {
        self.strains.get(lane)
    }

    /// Computes gradient and Hessian of every lane.
    pub(crate) fn derivatives(
        &self,
        set: InstructionSet,
        beside: Beside,
        gradients: &mut GradientLanes,
        hessians: &mut HessianLanes,
    ) {
        if self.has_angles {
            derivatives_of_angles(set, self, beside, gradients, hessians);
        } else {
            derivatives_of_tangents(set, self, beside, gradients, hessians);
        }
    }

    /// Gradient of every lane.
    pub(crate) fn gradients(
        &self,
        set: InstructionSet,
        beside: Beside,
        gradients: &mut GradientLanes,
    ) {
        if self.has_angles {
            gradients_of_angles(set, self, beside, gradients);
        } else {
            gradients_of_tangents(set, self, beside, gradients);
        }
    }

    /// Factor of the curvatures in a lane, and the moments on the resulting strains.
    #[inline(always)]
    fn angle_moments(&self, beside: &Beside, lane: usize) -> (AngleRatio, Moments) {
        let chi = 1.0 + beside[0].tangent(lane).dot(&beside[1].tangent(lane));
        let ratio = AngleRatio::of(0.5 * chi, self.angle[lane]);
        let turning = ratio.turning(&self.strains.get(lane));
        let natural = self.natural.get(lane);
        (
            ratio,
            Moments::new(&turning, &natural, &self.stiffness(lane)),
        )
    }

    #[inline(always)]
    fn stiffness(&self, lane: usize) -> VertexStiffness {
        VertexStiffness {
            bending: [self.bending[0][lane], self.bending[1][lane]],
            twisting: self.twisting[lane],
        }
    }
}

/// Up to [`LANES`] vertices of rods with their edges, structure of arrays.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct VertexLanes {
    before: FrameLanes,
    after: FrameLanes,
    /// Reference directors of the edges.
    reference: [VectorLanes; 2],
    sections: SectionLanes,
    is_chain: bool,
}

impl VertexLanes {
    /// Natural strains and stiffness of `vertices`; unused lanes hold a straight rod without
    /// stiffness.
    pub(crate) fn new(vertices: &[Vertex]) -> Self {
        let mut sections = SectionLanes::new(have_angles(vertices));
        for (lane, vertex) in vertices.iter().enumerate() {
            sections.set(lane, vertex);
        }
        Self {
            before: FrameLanes::new(),
            after: FrameLanes::new(),
            reference: [every_lane(Vector3::y()); 2],
            sections,
            is_chain: vertices.len() == LANES
                && vertices
                    .windows(2)
                    .all(|pair| pair[0].after == pair[1].before),
        }
    }

    /// Copies the natural strains and stiffnesses of `vertices`.
    pub(crate) fn take_natural_strains(&mut self, vertices: &[Vertex]) {
        for (lane, vertex) in vertices.iter().enumerate() {
            self.sections.take_natural_strains(lane, vertex);
        }
    }

    /// Puts the frame and the reference director of the edge before a vertex into a lane.
    pub(crate) fn set_before(&mut self, lane: usize, edge: &EdgeFrame, reference: &Vector3) {
        self.before.set(lane, edge);
        set_vector(&mut self.reference[0], lane, reference);
    }

    /// Puts the frame and the reference director of the edge after a vertex into a lane.
    pub(crate) fn set_after(&mut self, lane: usize, edge: &EdgeFrame, reference: &Vector3) {
        self.after.set(lane, edge);
        set_vector(&mut self.reference[1], lane, reference);
    }

    /// Whether every lane is in use and the edge after each vertex is the edge before the next.
    pub(crate) fn is_chain(&self) -> bool {
        self.is_chain
    }

    /// Copies the edge after each vertex to the edge before the next.
    pub(crate) fn chain(&mut self) {
        self.before.shift_from(&self.after);
        let [before, after] = &mut self.reference;
        shift(before, after);
    }

    /// Computes the curvatures of every lane, and the angle between the reference directors.
    pub(crate) fn bend(&mut self, set: InstructionSet) -> Lanes {
        let [before, after] = &self.reference;
        let beside = [&self.before, &self.after];
        self.sections.bend(set, beside, [before, after])
    }

    /// Sets the twist of a lane, rad.
    pub(crate) fn set_twist(&mut self, lane: usize, twist: f64) {
        self.sections.strains.twist[lane] = twist;
    }

    /// The twist of a lane, rad.
    pub(crate) fn twist(&self, lane: usize) -> f64 {
        self.sections.strains.twist[lane]
    }

    /// Strains, natural strains and stiffnesses.
    pub(super) fn sections(&self) -> &SectionLanes {
        &self.sections
    }

    /// Strains of a lane.
    pub(crate) fn strains(&self, lane: usize) -> VertexStrains {
        self.sections.strains(lane)
    }

    /// Sets the strains of a lane.
    pub(crate) fn set_strains(&mut self, lane: usize, strains: &VertexStrains) {
        self.sections.strains.set(lane, strains);
    }

    /// Computes gradient and Hessian of every lane.
    pub(crate) fn derivatives(
        &self,
        set: InstructionSet,
        gradients: &mut GradientLanes,
        hessians: &mut HessianLanes,
    ) {
        let beside = [&self.before, &self.after];
        self.sections.derivatives(set, beside, gradients, hessians);
    }

    /// Gradient of every lane.
    pub(crate) fn gradients(&self, set: InstructionSet, gradients: &mut GradientLanes) {
        let beside = [&self.before, &self.after];
        self.sections.gradients(set, beside, gradients);
    }
}

kernel! {
    /// Computes [`vertex::curvatures`] in every lane, and the angle from the transported reference
    /// director before to the one after.
    fn bend(
        beside: Beside,
        reference: [&VectorLanes; 2],
        curvature: &mut [Lanes; 4],
        angle: &mut Lanes,
    ) {
        for lane in 0..LANES {
            let (before, after) = (beside[0].get(lane), beside[1].get(lane));
            let from = vector(reference[0], lane);
            let carried = parallel_transport(&from, &before.tangent, &after.tangent);
            let to = vector(reference[1], lane);
            let sine = carried.cross(&to).dot(&after.tangent);
            angle[lane] = angle_of(sine, carried.dot(&to));
            let [c0, c1, c2, c3] = vertex::curvatures(&before, &after);
            curvature[0][lane] = c0;
            curvature[1][lane] = c1;
            curvature[2][lane] = c2;
            curvature[3][lane] = c3;
        }
    }
}

/// Gradients with respect to (x₋, θ⁰, x, θ¹, x₊).
pub(super) type GradientLanes = [Lanes; VERTEX_UNKNOWNS];

/// Lower triangles of Hessians with respect to (x₋, θ⁰, x, θ¹, x₊): entry (i, j) at `[j][i - j]`,
/// as in a band matrix.
pub(super) type HessianLanes = [[Lanes; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];

kernel! {
    /// Computes [`vertex::gradient`] and [`vertex_hessian::hessian`] in every lane.
    fn derivatives_of_tangents(vertices: &SectionLanes, beside: Beside, gradients: &mut GradientLanes, hessians: &mut HessianLanes) {
        for lane in 0..LANES {
            let (before, after) = (beside[0].get(lane), beside[1].get(lane));
            let (strains, natural) = (vertices.strains.get(lane), vertices.natural.get(lane));
            let stiffness = vertices.stiffness(lane);
            let gradient = vertex::gradient(&before, &after, &strains, &natural, &stiffness);
            let h = vertex_hessian::hessian(&before, &after, &strains, &natural, &stiffness);
            store_gradient(&gradient, lane, gradients);
            store_hessian(&h, lane, hessians);
        }
    }
}

kernel! {
    /// Computes [`vertex::gradient`] in every lane.
    fn gradients_of_tangents(vertices: &SectionLanes, beside: Beside, gradients: &mut GradientLanes) {
        for lane in 0..LANES {
            let (before, after) = (beside[0].get(lane), beside[1].get(lane));
            let (strains, natural) = (vertices.strains.get(lane), vertices.natural.get(lane));
            let stiffness = vertices.stiffness(lane);
            let gradient = vertex::gradient(&before, &after, &strains, &natural, &stiffness);
            store_gradient(&gradient, lane, gradients);
        }
    }
}

kernel! {
    /// Computes gradient and Hessian if some lanes bend by the turning angle.
    fn derivatives_of_angles(vertices: &SectionLanes, beside: Beside, gradients: &mut GradientLanes, hessians: &mut HessianLanes) {
        for lane in 0..LANES {
            let (before, after) = (beside[0].get(lane), beside[1].get(lane));
            let kappa = vertices.strains.get(lane).curvature;
            let (ratio, moments) = vertices.angle_moments(&beside, lane);
            let gradient = ratio.over_components(&moments, &kappa).gradient(&before, &after);
            let stiffness = vertices.stiffness(lane);
            let h = vertex_hessian::hessian_of_angle(&before, &after, &kappa, &moments, &ratio, &stiffness);
            store_gradient(&gradient, lane, gradients);
            store_hessian(&h, lane, hessians);
        }
    }
}

kernel! {
    /// The gradients alone.
    fn gradients_of_angles(vertices: &SectionLanes, beside: Beside, gradients: &mut GradientLanes) {
        for lane in 0..LANES {
            let (before, after) = (beside[0].get(lane), beside[1].get(lane));
            let kappa = vertices.strains.get(lane).curvature;
            let (ratio, moments) = vertices.angle_moments(&beside, lane);
            let gradient = ratio.over_components(&moments, &kappa).gradient(&before, &after);
            store_gradient(&gradient, lane, gradients);
        }
    }
}

#[inline(always)]
fn store_gradient(gradient: &VertexGradient, lane: usize, gradients: &mut GradientLanes) {
    for axis in 0..3 {
        gradients[axis][lane] = -gradient.e0[axis];
        gradients[4 + axis][lane] = gradient.e0[axis] - gradient.e1[axis];
        gradients[8 + axis][lane] = gradient.e1[axis];
    }
    gradients[3][lane] = gradient.phi0;
    gradients[7][lane] = gradient.phi1;
}

#[inline(always)]
fn store_hessian(h: &VertexHessian, lane: usize, hessians: &mut HessianLanes) {
    for i in 0..3 {
        for j in 0..3 {
            let (a, b, c) = (h.e0e0[(i, j)], h.e1e0[(i, j)], h.e1e1[(i, j)]);
            if j <= i {
                hessians[j][i - j][lane] = a;
                hessians[4 + j][i - j][lane] = a - b - h.e1e0[(j, i)] + c;
                hessians[8 + j][i - j][lane] = c;
            }
            hessians[j][4 + i - j][lane] = b - a;
            hessians[j][8 + i - j][lane] = -b;
            hessians[4 + j][4 + i - j][lane] = b - c;
        }
        hessians[i][3 - i][lane] = -h.e0phi0[i];
        hessians[i][7 - i][lane] = -h.e0phi1[i];
        hessians[3][1 + i][lane] = h.e0phi0[i] - h.e1phi0[i];
        hessians[3][5 + i][lane] = h.e1phi0[i];
        hessians[4 + i][3 - i][lane] = h.e0phi1[i] - h.e1phi1[i];
        hessians[7][1 + i][lane] = h.e1phi1[i];
    }
    hessians[3][0][lane] = h.phi0phi0;
    hessians[3][4][lane] = h.phi1phi0;
    hessians[7][0][lane] = h.phi1phi1;
}
