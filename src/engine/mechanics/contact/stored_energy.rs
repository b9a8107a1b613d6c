//! Contact energy at any configuration, without changing the last evaluation.

use super::contact_system::ContactSystem;
use super::contacts::CandidatePair;
use super::foot::Points;
use super::nearest_points::NearestPoints;
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use crate::mechanics::Vector3;

/// Energy stored in contacts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stored {
    /// J.
    pub energy: f64,
    /// Contacts within the distance tolerance δ.
    pub contacts: usize,
}

/// A contact within reach of its potential.
struct Felt {
    nodes: [usize; 4],
    weights: [f64; 4],
    normal: Vector3,
    /// m.
    gap: f64,
    /// Energy and force; negative for a counter-pair.
    response: NormalResponse,
}

impl ContactSystem {
    /// Energy of all contacts at `positions` (m), J, with obstacles at their poses at the end of
    /// the step. The candidates must cover these positions. Rigid contacts store no energy.
    pub(crate) fn energy_at(&self, positions: &[Vector3]) -> f64 {
        self.stored(&self.obstacles.points(&self.placed(positions)))
            .energy
    }

    /// Contact energy with obstacles at their poses at the start of the step, and the contacts
    /// within δ there.
    pub(crate) fn stored_at_start(&self, positions: &[Vector3]) -> Stored {
        self.stored(&self.obstacles.points_at_start(&self.placed(positions)))
    }

    /// Adds, for every node, a factor times the gradient of the energy at the start of the step.
    pub(crate) fn add_gradient_at_start(
        &self,
        positions: &[Vector3],
        factor: f64,
        add: &mut dyn FnMut(usize, Vector3),
    ) {
        self.visit_felt(
            &self.obstacles.points_at_start(&self.placed(positions)),
            &mut |felt| {
                let force = felt.normal * (-factor * felt.response.force);
                let corners = felt.nodes.into_iter().zip(felt.weights);
                for (node, weight) in corners.filter(|(node, _)| self.is_of_rod(*node)) {
                    self.spread(node, (force * weight).into(), |node, part| {
                        add(node, part.into());
                    });
                }
            },
        );
    }

    fn stored(&self, points: &Points) -> Stored {
        let mut stored = Stored::default();
        let tolerance = self.parameters.distance_tolerance;
        self.visit_felt(points, &mut |felt| {
            stored.energy += felt.response.energy;
            stored.contacts += usize::from(felt.gap < tolerance);
        });
        stored
    }

    fn visit_felt(&self, points: &Points, visit: &mut dyn FnMut(Felt)) {
        if self.parameters.is_complementarity() {
            return;
        }
        let pairs = self.candidates.pairs().iter().zip(self.candidates.gaps());
        for (pair, earlier) in pairs {
            if let Some(felt) = self.felt(pair, *earlier, points) {
                visit(felt);
            }
        }
        for (index, plane) in self.planes.iter().enumerate() {
            for node in self.surface.nodes() {
                let gap = plane.distance(&points.nodes[node.node]) - node.radius;
                let is_felt = gap < self.parameters.reach()
                    && !self.surface.roots.frees_from_plane(node.node, index)
                    && !self.is_prescribed(node.node);
                if is_felt {
                    let stiffness = self.stiffness_between(node.node, node.node);
                    visit(Felt {
                        nodes: [node.node; 4],
                        weights: [1.0, 0.0, 0.0, 0.0],
                        normal: plane.normal,
                        gap,
                        response: self.response_of_gap(gap, node.radius, stiffness),
                    });
                }
            }
        }
    }

    /// A candidate whose gap was `earlier` (m) when the candidates were built; `None` beyond reach.
    fn felt(&self, pair: &CandidatePair, earlier: f64, points: &Points) -> Option<Felt> {
        let reach = self.parameters.reach();
        if self.is_of_rod(pair.nodes[3]) {
            let built = self.candidates.positions();
            let moved = (pair.nodes).map(|node| (points.at(node) - built[node]).norm());
            if earlier - pair.approach(moved) >= reach {
                return None;
            }
        }
        let threshold = self.surface.threshold(pair.edges);
        let smoothing = self.parameters.smoothing(threshold);
        let nearest = NearestPoints::of(&self.surface, pair, points, smoothing)?;
        let pair = &nearest.settled(&self.surface, pair);
        let core = self.surface.core(pair);
        let gap = nearest.distance() - core - threshold - self.standoff(pair);
        let (weights, normal) = (nearest.weights(), nearest.normal());
        let is_felt = gap < reach
            && !self.surface.is_at_reflex_edge(pair, &normal, points)
            && !self.are_prescribed(&pair.nodes, &weights);
        let stiffness = self.stiffness_between(pair.nodes[0], pair.nodes[3]);
        let scale = self.surface.law_scale(pair.edges);
        let response = self.response_of_gap(gap, scale, stiffness);
        // A counter-pair subtracts energy that counts twice; it is omitted where this energy is
        // infinite.
        let counts = is_felt && (pair.sign() > 0.0 || response.energy.is_finite());
        counts.then(|| Felt {
            nodes: pair.nodes,
            weights,
            normal,
            gap,
            response: NormalResponse {
                energy: pair.sign() * response.energy,
                force: pair.sign() * response.force,
                ..response
            },
        })
    }

    fn response_of_gap(&self, gap: f64, scale: f64, stiffness: f64) -> NormalResponse {
        let law = NormalLaw::new(&self.parameters, scale, stiffness);
        law.response(self.counted_gap(gap))
    }
}
