//! The flow of rods that spin about their own axes.
//!
//! An edge of radius r and tangent t that spins about itself at ω exerts on the fluid the torque
//! 4πη r² ω t per length, that of a long cylinder. The flow of the edge at x is that of rotlets
//! along the edge,
//!
//! ```text
//! u(x) = ½ r² ω ∫₀ᴸ t × R/|R|³ ds = ½ r² ω (t × R) [ (s − a)/(q² √(q² + (s − a)²)) ]₀ᴸ
//! ```
//!
//! with R from the start of the edge, a = t·R, and q the distance from its line. Beside a long rod
//! this is ω r²/q, and ω r at the surface; inside (q < r) it grows from zero in proportion to q. A
//! straight rod does not move itself; a bent one does.
//!
//! The reverse effect is omitted: an edge in the vorticity of others would spin with it. So the
//! torque on an edge is that of its own spin alone.

use super::Filament;
use super::lanes::add_lanes;
use super::stations::edges_of;
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Eight spinning edges, structure of arrays.
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct EdgeLanes {
    start: [Lanes; 3],
    tangent: [Lanes; 3],
    length: Lanes,
    /// r².
    radius_squared: Lanes,
    /// ½ r² ω, m²/s.
    strength: Lanes,
}

/// The rotlets of all edges.
pub(super) struct Rotlets {
    set: InstructionSet,
    edges: Vec<EdgeLanes>,
    /// Whether any edge spins.
    spin: bool,
}

impl Rotlets {
    /// Creates rotlets for filaments whose edges do not spin yet.
    pub(crate) fn new(filaments: &[Filament]) -> Self {
        let edges: usize = filaments.iter().map(Filament::edges).sum();
        let void = EdgeLanes {
            // Lanes after the last edge have no strength, but must contain finite numbers.
            radius_squared: [1.0; LANES],
            ..EdgeLanes::default()
        };
        Self {
            set: InstructionSet::best(),
            edges: vec![void; edges.div_ceil(LANES)],
            spin: false,
        }
    }

    /// Whether any edge spins.
    pub(crate) fn spin(&self) -> bool {
        self.spin
    }

    /// Places the edges at these stations, m. `spins` holds their spins, rad/s, at the nodes of
    /// the scene at which they start.
    pub(crate) fn set(&mut self, filaments: &[Filament], stations: &[Vector3], spins: &[f64]) {
        self.spin = false;
        for (number, (filament, edge, ends)) in edges_of(filaments).enumerate() {
            let [start, end] = ends.map(|station| stations[station]);
            let square = filament.radius * filament.radius;
            let length = (end - start).norm();
            let tangent = (end - start) / length;
            let spin = spins[filament.first_node + edge];
            let (lanes, lane) = (&mut self.edges[number / LANES], number % LANES);
            for axis in 0..3 {
                lanes.start[axis][lane] = start[axis];
                lanes.tangent[axis][lane] = tangent[axis];
            }
            lanes.length[lane] = length;
            lanes.radius_squared[lane] = square;
            lanes.strength[lane] = 0.5 * square * spin;
            self.spin |= spin != 0.0;
        }
    }

    /// Velocity at a place, m/s.
    pub(crate) fn velocity(&self, x: &Vector3) -> Vector3 {
        Vector3::from(velocity(self.set, (*x).into(), &self.edges))
    }
}

kernel! {
    /// Velocity at `x` due to all edges.
    fn velocity(x: [f64; 3], edges: &[EdgeLanes]) -> [f64; 3] {
        let mut sum = [[0.0; LANES]; 3];
        for edges in edges {
            let (start, tangent) = (&edges.start, &edges.tangent);
            for lane in 0..LANES {
                let r = [x[0] - start[0][lane], x[1] - start[1][lane], x[2] - start[2][lane]];
                let t = [tangent[0][lane], tangent[1][lane], tangent[2][lane]];
                let along = t[0] * r[0] + t[1] * r[1] + t[2] * r[2];
                let across = [
                    t[1] * r[2] - t[2] * r[1],
                    t[2] * r[0] - t[0] * r[2],
                    t[0] * r[1] - t[1] * r[0],
                ];
                let distance = across[0] * across[0] + across[1] * across[1] + across[2] * across[2];
                let square = distance.max(edges.radius_squared[lane]);
                let ends = [-along, edges.length[lane] - along];
                let of_end = |s: f64| s / (square + s * s).sqrt();
                let factor = edges.strength[lane] * (of_end(ends[1]) - of_end(ends[0])) / square;
                for axis in 0..3 {
                    sum[axis][lane] += factor * across[axis];
                }
            }
        }
        add_lanes(&sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filament(nodes: usize, closed: bool) -> Filament {
        Filament {
            first_node: 0,
            nodes,
            closed,
            radius: 0.01,
        }
    }

    #[test]
    fn a_long_rod_moves_the_fluid_at_its_surface_as_it_spins() {
        let filaments = [filament(11, false)];
        let stations: Vec<Vector3> = (0..11).map(|k| Vector3::z() * f64::from(k - 5)).collect();
        let mut rotlets = Rotlets::new(&filaments);
        rotlets.set(&filaments, &stations, &[3.0; 11]);
        for (distance, expected) in [(0.01, 0.03), (0.02, 0.015), (0.005, 0.015), (0.0, 0.0)] {
            let u = rotlets.velocity(&(Vector3::x() * distance));
            assert!(
                (u - Vector3::y() * expected).norm() < 1e-6,
                "{distance}: {u}"
            );
        }
        // A straight rod does not move itself.
        assert_eq!(rotlets.velocity(&stations[3]), Vector3::zeros());
    }

    #[test]
    fn far_from_a_short_edge_the_flow_is_that_of_its_torque() {
        let filaments = [filament(2, false)];
        let stations = [Vector3::zeros(), Vector3::new(0.0, 0.0, 1e-3)];
        let mut rotlets = Rotlets::new(&filaments);
        rotlets.set(&filaments, &stations, &[-2.0, 0.0]);
        let x = Vector3::new(0.3, -0.2, 0.4);
        // T × r/(8πη r³) for T = 4πη r² ω L t.
        let r: Vector3 = x - Vector3::z() * 0.5e-3;
        let expected = Vector3::z().cross(&r) * (0.5 * 1e-4 * -2.0 * 1e-3 / r.norm().powi(3));
        assert!((rotlets.velocity(&x) - expected).norm() < 1e-5 * expected.norm());
    }

    #[test]
    fn a_ring_that_turns_inside_out_moves_along_its_axis() {
        let nodes = 64;
        let filaments = [filament(nodes, true)];
        let stations: Vec<Vector3> = (0..nodes)
            .map(|k| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / nodes as f64);
                Vector3::new(cos, sin, 0.0)
            })
            .collect();
        let mut rotlets = Rotlets::new(&filaments);
        rotlets.set(&filaments, &stations, &vec![1.0; nodes]);
        let u = rotlets.velocity(&stations[0]);
        assert!(u.x.abs() < 1e-12 && u.y.abs() < 1e-12, "{u}");
        // Upwards at the centre of the ring, u = ½ r² ω ∮ t × R/R³ = π r² ω.
        let middle = rotlets.velocity(&Vector3::zeros());
        let expected = Vector3::z() * (std::f64::consts::PI * 1e-4);
        assert!(
            (middle - expected).norm() < 1e-2 * expected.norm(),
            "{middle}"
        );
        assert!(u.z > 0.0);
    }
}
