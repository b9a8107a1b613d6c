//! One collocation step: the equations of the rod on an interval, linearised about a guess.
//!
//! t' = M × t, M' = −λ t × n with λ = 1 + n·t/k̄_s, n(s) = n(0) + s ẑ/2 (EI = L_gb = 1). Gauss collocation keeps
//! the quadratic invariants |t| = 1 and M·t = 0 exactly.

use super::gauss::{RULE, STAGES};
use super::{Vector3, WEIGHT};
use rodlab_engine::mechanics::Matrix3;

/// Unknowns of an interval: the tangents at its stages.
const UNKNOWNS: usize = 3 * STAGES;
/// Number of right-hand sides: two homogeneous solutions and a particular one.
pub const COLUMNS: usize = 3;
/// Index of the particular solution.
pub const PARTICULAR: usize = 2;

/// Tangent, moment and the unknown components y, z of the force n(0).
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// t.
    pub tangent: Vector3,
    /// M.
    pub moment: Vector3,
    /// n_y(0), n_z(0).
    pub force: [f64; 2],
}

impl State {
    /// Sum of products of all components.
    pub fn dot(&self, other: &Self) -> f64 {
        self.tangent.dot(&other.tangent)
            + self.moment.dot(&other.moment)
            + self.force[0] * other.force[0]
            + self.force[1] * other.force[1]
    }

    /// Adds a multiple of another state.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.tangent += factor * other.tangent;
        self.moment += factor * other.moment;
        self.force[0] += factor * other.force[0];
        self.force[1] += factor * other.force[1];
    }

    /// A multiple of it.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = Self::default();
        scaled.add(factor, self);
        scaled
    }
}

/// A part of the rod, with its values at the stages.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    /// s at its start.
    pub start: f64,
    /// Length of the interval.
    pub length: f64,
    /// t at the stages.
    pub tangents: [Vector3; STAGES],
    /// M at the stages.
    pub moments: [Vector3; STAGES],
}

/// New values at the stages for each of the three columns.
#[derive(Clone, Copy, Debug)]
pub struct Stages {
    /// t.
    pub tangents: [[Vector3; COLUMNS]; STAGES],
    /// M.
    pub moments: [[Vector3; COLUMNS]; STAGES],
}

impl Interval {
    /// s at a stage.
    pub fn place(&self, stage: usize) -> f64 {
        self.start + self.length * RULE.nodes[stage]
    }

    /// Propagates three solutions of the linearised equations from the start of the interval to
    /// its end.
    pub fn carry(
        &self,
        columns: &[State; COLUMNS],
        force: [f64; 2],
        compliance: f64,
    ) -> (Stages, [State; COLUMNS]) {
        let h = self.length;
        let a = &RULE.matrix;
        let tangents = &self.tangents;
        let products: [Vector3; STAGES] =
            std::array::from_fn(|k| tangents[k].cross(&self.moments[k]));
        // M' at a stage for new values: slope · t + by_force · n(0) + rest.
        let slopes: [MomentSlope; STAGES] = std::array::from_fn(|k| {
            MomentSlope::new(&tangents[k], force, self.place(k), compliance)
        });
        let sources: [[Vector3; COLUMNS]; STAGES] =
            std::array::from_fn(|k| slopes[k].sources(columns));

        let mut system = [[0.0; UNKNOWNS + COLUMNS]; UNKNOWNS];
        for j in 0..STAGES {
            let mut lever = Vector3::zeros();
            let mut known = Vector3::zeros();
            for k in 0..STAGES {
                lever += a[j][k] * tangents[k];
                known += a[j][k] * products[k];
            }
            let mut right: [Vector3; COLUMNS] = std::array::from_fn(|column| {
                columns[column].tangent - h * lever.cross(&columns[column].moment)
            });
            right[PARTICULAR] += h * known;
            for l in 0..STAGES {
                let mut lever = Vector3::zeros();
                for k in 0..STAGES {
                    lever += a[j][k] * a[k][l] * tangents[k];
                }
                lever *= h * h;
                let block = lever.cross_matrix() * slopes[l].by_tangent
                    - (h * a[j][l]) * self.moments[l].cross_matrix();
                for row in 0..3 {
                    for column in 0..3 {
                        system[3 * j + row][3 * l + column] = block[(row, column)];
                    }
                }
                for column in 0..COLUMNS {
                    right[column] -= lever.cross(&sources[l][column]);
                }
            }
            for row in 0..3 {
                system[3 * j + row][3 * j + row] += 1.0;
                for column in 0..COLUMNS {
                    system[3 * j + row][UNKNOWNS + column] = right[column][row];
                }
            }
        }
        eliminate(&mut system);

        let new: [[Vector3; COLUMNS]; STAGES] = std::array::from_fn(|k| {
            std::array::from_fn(|column| {
                Vector3::from_fn(|row, _| system[3 * k + row][UNKNOWNS + column])
            })
        });
        let moment_slopes: [[Vector3; COLUMNS]; STAGES] = std::array::from_fn(|k| {
            std::array::from_fn(|column| slopes[k].by_tangent * new[k][column] + sources[k][column])
        });
        let moments: [[Vector3; COLUMNS]; STAGES] = std::array::from_fn(|j| {
            std::array::from_fn(|column| {
                let mut moment = columns[column].moment;
                for k in 0..STAGES {
                    moment += h * a[j][k] * moment_slopes[k][column];
                }
                moment
            })
        });
        let ends = std::array::from_fn(|column| {
            let mut end = columns[column];
            for k in 0..STAGES {
                let weight = h * RULE.weights[k];
                let mut turn =
                    self.moments[k].cross(&new[k][column]) - tangents[k].cross(&moments[k][column]);
                if column == PARTICULAR {
                    turn += products[k];
                }
                end.tangent += weight * turn;
                end.moment += weight * moment_slopes[k][column];
            }
            end
        });
        let stages = Stages {
            tangents: new,
            moments,
        };
        (stages, ends)
    }
}

/// M' = −λ t × n at a stage, linearised.
struct MomentSlope {
    by_tangent: Matrix3,
    by_force: [Vector3; 2],
    rest: Vector3,
}

impl MomentSlope {
    fn new(tangent: &Vector3, force: [f64; 2], place: f64, compliance: f64) -> Self {
        let n = Vector3::new(0.0, force[0], force[1] + WEIGHT * place);
        let stretch = 1.0 + compliance * n.dot(tangent);
        let across = tangent.cross(&n);
        let by_tangent = stretch * n.cross_matrix() - compliance * across * n.transpose();
        let by_force = [Vector3::y(), Vector3::z()].map(|axis| {
            -(stretch * tangent.cross(&axis) + compliance * axis.dot(tangent) * across)
        });
        let rest = -stretch * across
            - by_tangent * tangent
            - by_force[0] * force[0]
            - by_force[1] * force[1];
        Self {
            by_tangent,
            by_force,
            rest,
        }
    }

    fn sources(&self, columns: &[State; COLUMNS]) -> [Vector3; COLUMNS] {
        std::array::from_fn(|column| {
            let [y, z] = columns[column].force;
            let source = y * self.by_force[0] + z * self.by_force[1];
            if column == PARTICULAR {
                source + self.rest
            } else {
                source
            }
        })
    }
}

/// Gaussian elimination with row pivoting; the solutions are in the last columns.
pub fn eliminate<const ROWS: usize, const WIDTH: usize>(system: &mut [[f64; WIDTH]; ROWS]) {
    for pivot in 0..ROWS {
        let largest = (pivot..ROWS)
            .max_by(|one, other| {
                system[*one][pivot]
                    .abs()
                    .total_cmp(&system[*other][pivot].abs())
            })
            .unwrap_or(pivot);
        system.swap(pivot, largest);
        let inverse = 1.0 / system[pivot][pivot];
        for entry in &mut system[pivot][pivot..] {
            *entry *= inverse;
        }
        let row = system[pivot];
        for other in pivot + 1..ROWS {
            let factor = system[other][pivot];
            for column in pivot..WIDTH {
                system[other][column] -= factor * row[column];
            }
        }
    }
    for pivot in (0..ROWS).rev() {
        let row = system[pivot];
        for other in 0..pivot {
            let factor = system[other][pivot];
            for column in ROWS..WIDTH {
                system[other][column] -= factor * row[column];
            }
        }
    }
}
