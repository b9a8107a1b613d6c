//! Spheres in the flow of filaments.
//!
//! A sphere adds two unknowns to the flow, its force and its torque, and two velocities, those of
//! its centre and of its surface. With the collocation matrix A of the points, all velocities are
//!
//! ```text
//! [ u ]   [ A  B ] [ f ]
//! [ w ] = [ C  M ] [ s ],    w = (U, aΩ),  s = (φ, τ)
//! ```
//!
//! where B is the flow of a sphere at the points, C is Faxén's laws for the force densities,
//! linear along the edges, and M is the interaction of spheres ([`sphere`]). Nodes that start
//! inside a sphere are part of it and carry no force.
//!
//! **Omitted.** A sphere moves with the flow of others at its centre and the curvature of that
//! flow, but its surface does not change their flow further: a force just outside a sphere lacks
//! its exact image (Oseen 1927). Where a filament leaves a sphere that pulls it, the fluid moves
//! with the sphere, so the forces there are small.

mod sphere;
#[cfg(test)]
mod tests;

use sphere::Influence;
pub(crate) use sphere::Sphere;

use super::Filament;
use super::points::Points;
use super::stations::edges_of;
use crate::mechanics::{Matrix3, Vector3};
use std::ops::Range;

/// Unknowns of a sphere.
const UNKNOWNS: usize = 6;
/// Gauss points on an edge, and their weights, for an interval from 0 to 1. For an edge as long as
/// the radius, beside the sphere, the error is some 10⁻⁴.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// The spheres of a flow, and the interactions of spheres and points.
#[derive(Clone, Debug, Default)]
pub(super) struct Spheres {
    spheres: Vec<Sphere>,
    /// Whether each station is inside a sphere and thus part of it.
    inside: Vec<bool>,
    /// Points inside spheres, in ascending order.
    points_inside: Vec<usize>,
    /// Action of each sphere on each point, sphere by sphere.
    on_points: Vec<Influence>,
    /// Action of each point on each sphere.
    on_spheres: Vec<Influence>,
    /// Action of each sphere on each sphere, row by row.
    on_each_other: Vec<[[Matrix3; 2]; 2]>,
}

impl Spheres {
    /// Creates the spheres for filaments with stations at `stations`, m; the centres of the
    /// spheres are in `positions`, m.
    pub(crate) fn new(spheres: &[Sphere], stations: &[Vector3], positions: &[Vector3]) -> Self {
        let is_inside = |x: &Vector3| {
            let mut spheres = spheres.iter();
            spheres.any(|sphere| sphere.contains(&(x - positions[sphere.centre])))
        };
        Self {
            inside: stations.iter().map(is_inside).collect(),
            spheres: spheres.to_vec(),
            ..Self::default()
        }
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Places of their centres.
    pub(crate) fn centres(&self) -> impl Iterator<Item = usize> {
        self.spheres.iter().map(|sphere| sphere.centre)
    }

    /// Number of their unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        UNKNOWNS * self.spheres.len()
    }

    /// Whether a station is inside a sphere.
    pub(crate) fn hold(&self, station: usize) -> bool {
        !self.is_empty() && self.inside[station]
    }

    /// The points inside spheres, in ascending order.
    pub(crate) fn points_inside(&self) -> &[usize] {
        &self.points_inside
    }

    /// Sets other points of the same stations.
    pub(crate) fn take_points(&mut self, points: &Points) {
        self.points_inside.clear();
        let stations = points.representatives().iter().enumerate();
        let inside = stations.filter(|&(_, &station)| self.hold(station));
        self.points_inside = inside.map(|(point, _)| point).collect();
    }

    /// Evaluates all influences with stations at `stations` and centres at `positions`, m.
    pub(crate) fn assemble(
        &mut self,
        filaments: &[Filament],
        points: &Points,
        stations: &[Vector3],
        positions: &[Vector3],
    ) {
        if self.is_empty() {
            return;
        }
        let count = points.count();
        let representatives = points.representatives();
        self.on_points.clear();
        self.on_spheres.clear();
        self.on_spheres
            .resize(self.spheres.len() * count, Influence::default());
        self.on_each_other.clear();
        for (number, sphere) in self.spheres.iter().enumerate() {
            let centre = positions[sphere.centre];
            let on_points = representatives
                .iter()
                .map(|&station| sphere.influence(&(stations[station] - centre)));
            self.on_points.extend(on_points);
            let on_sphere = &mut self.on_spheres[count * number..][..count];
            add_edges(sphere, &centre, filaments, points, stations, on_sphere);
            let others = self.spheres.iter().enumerate().map(|(other, by)| {
                if other == number {
                    let of_force = Matrix3::identity() * (4.0 / 3.0);
                    return [
                        [of_force, Matrix3::zeros()],
                        [Matrix3::zeros(), Matrix3::identity()],
                    ];
                }
                sphere.by(by, &(centre - positions[by.centre]))
            });
            self.on_each_other.extend(others);
        }
        for &point in &self.points_inside {
            for number in 0..self.spheres.len() {
                self.on_points[count * number + point] = Influence::default();
                self.on_spheres[count * number + point] = Influence::default();
            }
        }
    }

    /// Adds the interactions of spheres and points to the velocities of points (u = A f) and of
    /// spheres. Points inside spheres have the equation u = f, which gives them no force if u is
    /// zero.
    pub(crate) fn couple(&self, densities: &[f64], velocities: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        let points = densities.len() - self.unknowns();
        let (f, s) = densities.split_at(points);
        let (u, w) = velocities.split_at_mut(points);
        for &point in &self.points_inside {
            let own = 3 * point..3 * point + 3;
            u[own.clone()].copy_from_slice(&f[own]);
        }
        let count = points / 3;
        w.fill(0.0);
        for number in 0..self.spheres.len() {
            let [force, torque] = unknowns_of(s, number);
            let [mut linear, mut turning] = [Vector3::zeros(); 2];
            let influences = self.on_points[count * number..][..count].iter();
            let back = &self.on_spheres[count * number..][..count];
            for (point, (on_point, on_sphere)) in influences.zip(back).enumerate() {
                let velocity = on_point.stokeslet * force + torque.cross(&on_point.rotlet);
                let own = 3 * point..3 * point + 3;
                let density = Vector3::from_column_slice(&f[own.clone()]);
                for (u, added) in u[own].iter_mut().zip(&velocity) {
                    *u += added;
                }
                linear += on_sphere.stokeslet * density;
                turning += density.cross(&on_sphere.rotlet);
            }
            let row = &self.on_each_other[self.spheres.len() * number..][..self.spheres.len()];
            for (other, [of_linear, of_turning]) in row.iter().enumerate() {
                let [force, torque] = unknowns_of(s, other);
                linear += of_linear[0] * force + of_linear[1] * torque;
                turning += of_turning[0] * force + of_turning[1] * torque;
            }
            w[range_of(number, 0)].copy_from_slice(linear.as_slice());
            w[range_of(number, 1)].copy_from_slice(turning.as_slice());
        }
    }

    /// Appends the velocities of spheres, U and aΩ, after those of the points.
    pub(crate) fn write_velocities(
        &self,
        positions: &[Vector3],
        velocities: &[Vector3],
        w: &mut [f64],
    ) {
        for (number, sphere) in self.spheres.iter().enumerate() {
            let surface = sphere.spin(positions, velocities) * sphere.radius;
            w[range_of(number, 0)].copy_from_slice(velocities[sphere.centre].as_slice());
            w[range_of(number, 1)].copy_from_slice(surface.as_slice());
        }
    }

    /// Computes the forces on centres and tips, N, from the unknowns `s`, with `factor` 8πη.
    pub(crate) fn write_forces(
        &self,
        factor: f64,
        s: &[f64],
        positions: &[Vector3],
        forces: &mut [Vector3],
    ) {
        for (number, sphere) in self.spheres.iter().enumerate() {
            let a = sphere.radius;
            let [force, torque] = unknowns_of(s, number);
            forces[sphere.centre] += force * (-factor * a);
            let torque = torque * (-factor * a * a);
            for tip in sphere.tips() {
                forces[tip] = sphere.force_on_tip(&torque, &positions[tip]);
            }
        }
    }

    /// Power that the unknowns `s` take from the velocities `w` of all spheres, divided by 8πη,
    /// m³/s².
    pub(crate) fn power(&self, s: &[f64], w: &[f64]) -> f64 {
        let powers = self.spheres.iter().enumerate().map(|(number, sphere)| {
            let [force, torque] = unknowns_of(s, number);
            let [linear, surface] = unknowns_of(w, number);
            sphere.radius * (force.dot(&linear) + torque.dot(&surface))
        });
        powers.sum()
    }

    /// Adds the resistances of centres and tips, N s/m.
    pub(crate) fn add_resistance(&self, viscosity: f64, resistance: &mut [Matrix3]) {
        for sphere in &self.spheres {
            let [of_centre, of_tip] = sphere
                .resistances(viscosity)
                .map(Matrix3::from_diagonal_element);
            resistance[sphere.centre] += of_centre;
            sphere
                .tips()
                .into_iter()
                .for_each(|tip| resistance[tip] = of_tip);
        }
    }

    /// Adds drag and resistance of each sphere as if it were alone in fluid at rest.
    pub(crate) fn add_own_drag(
        &self,
        viscosity: f64,
        velocities: &[Vector3],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) {
        self.add_resistance(viscosity, resistance);
        for sphere in &self.spheres {
            for place in sphere.tips().into_iter().chain([sphere.centre]) {
                forces[place] -= resistance[place] * velocities[place];
            }
        }
    }

    /// Divides the velocities of all spheres by the coefficients of their own unknowns.
    pub(crate) fn precondition(w: &[f64], s: &mut [f64]) {
        for (number, (own, velocity)) in s.chunks_exact_mut(3).zip(w.chunks_exact(3)).enumerate() {
            let inverse = if number.is_multiple_of(2) { 0.75 } else { 1.0 };
            for (own, velocity) in own.iter_mut().zip(velocity) {
                *own = inverse * velocity;
            }
        }
    }
}

/// Indices of φ or τ of a sphere among the unknowns of all spheres.
fn range_of(number: usize, unknown: usize) -> Range<usize> {
    let first = UNKNOWNS * number + 3 * unknown;
    first..first + 3
}

/// φ and τ of a sphere.
fn unknowns_of(s: &[f64], number: usize) -> [Vector3; 2] {
    [0, 1].map(|unknown| Vector3::from_column_slice(&s[range_of(number, unknown)]))
}

/// Adds the action of force densities at the points, linear along the edges, on a sphere.
fn add_edges(
    sphere: &Sphere,
    centre: &Vector3,
    filaments: &[Filament],
    points: &Points,
    stations: &[Vector3],
    on_sphere: &mut [Influence],
) {
    for (_, _, ends) in edges_of(filaments) {
        let [start, end] = ends.map(|station| stations[station]);
        let along = end - start;
        let length = along.norm();
        for (part, weight) in GAUSS {
            let influence = sphere.influence_of(&(centre - (start + along * part)));
            for (station, shape) in ends.into_iter().zip([1.0 - part, part]) {
                for share in points
                    .shares(station)
                    .iter()
                    .filter(|one| one.weight != 0.0)
                {
                    on_sphere[share.point].add(length * weight * shape * share.weight, &influence);
                }
            }
        }
    }
}
