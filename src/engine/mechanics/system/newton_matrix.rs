//! The Jacobian of the residual: a band for the rods, small dense elements for couplings between
//! distant nodes, and their factorisation.

use super::attached::AttachedNodes;
use super::constraint_matrix::ConstraintMatrix;
use super::curve_elements::CurveElements;
use super::turned_elements::{TurnedElements, matrices_of};
use super::whole_matrix::WholeMatrix;
use super::{Assembly, Stage};
use crate::linalg::{
    BandedFactor, BandedSymmetric, Couplings, Element, ElementMatrix, HALF_BANDWIDTH, Inertia,
    Islands, SharedUnknown, SingularMatrix, in_chunks,
};
use crate::mechanics::Matrix3;
use crate::mechanics::contact::{CandidatePair, ConstraintPlace, ContactSystem, TurnedBodies};
use crate::mechanics::rod::{ElasticRods, RodGeometry, STRIDE};
use std::ops::Range;

const ZERO: ElementMatrix = [[0.0; 12]; 12];

/// The Jacobian and its factors. Storage is reused, and patterns are kept as long as the same
/// pairs of edges are coupled.
///
/// Elements are numbered in this order: elements of the terms, first those of the elasticity of
/// rods (closing vertices of rings and half vertices at joints); coupled contact candidates of two
/// rods; with obstacles one element per edge; with friction on planes or obstacles, or with rigid
/// contact, one per node. Without couplings the rods are factored as a band; contact with planes
/// and obstacles alone adds no couplings.
pub(crate) struct NewtonMatrix {
    band: BandedSymmetric,
    factor: BandedFactor,
    coupled: Option<Islands>,
    held: Vec<bool>,
    /// Positions of joined nodes that are owned by other nodes.
    shared: Vec<SharedUnknown>,
    /// First node of each rod, then the places of frames.
    chains: Vec<usize>,
    symmetric: bool,
    /// Whether the symmetric elimination has failed with this pattern.
    lost_symmetry: bool,
    /// Elements of the terms, always present.
    permanent: Vec<Element>,
    permanent_matrices: Vec<ElementMatrix>,
    /// End of the elements of each term in this list.
    ends: Vec<usize>,
    /// Number of elements of the rods.
    closing: usize,
    /// Elements of contacts active in this linearisation.
    active: Vec<(usize, ElementMatrix)>,
    contact_elements: Vec<Element>,
    /// Element of each candidate among those of contacts; `None` for a candidate that is part of
    /// the band or not coupled.
    candidate_elements: Vec<Option<usize>>,
    /// Index of the first element of a node among those of contacts.
    first_node_element: usize,
    /// Vertices of free bodies.
    attached: AttachedNodes,
    /// Elements of the contacts that turn edges, among those of contacts.
    turned_elements: TurnedElements,
    /// Elements of contact of smooth curves.
    curve_elements: CurveElements,
    /// Whether the coupled candidates differ from those for which elements were listed.
    candidates_changed: bool,
    /// Whether contact of nodes with planes and obstacles has its own elements.
    lists_nodes: bool,
    uses_band: bool,
    spin_moment: Vec<f64>,
    /// Unknowns isolated since the last linearisation, with their diagonal entries.
    isolated: Vec<(usize, f64)>,
}

/// Target to which a term adds its part of the Jacobian.
pub(crate) struct Entries<'a> {
    matrix: &'a mut NewtonMatrix,
    /// Its elements.
    own: Range<usize>,
}

impl Entries<'_> {
    /// The lower half of the band of the rods, a column for each unknown.
    pub(crate) fn columns(&mut self) -> &mut [[f64; HALF_BANDWIDTH + 1]] {
        self.matrix.band.columns_mut()
    }

    /// The matrices of the term's elements, in their order.
    pub(crate) fn elements(&mut self) -> &mut [ElementMatrix] {
        &mut self.matrix.permanent_matrices[self.own.clone()]
    }

    /// The whole matrix.
    pub(crate) fn matrix(&mut self) -> &mut NewtonMatrix {
        self.matrix
    }
}

impl NewtonMatrix {
    /// Creates the matrix for terms with these elements; `symmetric` if the forces of all terms
    /// have a potential. Contact of nodes with planes and obstacles has its own elements if the
    /// matrix `lists_nodes`.
    pub(crate) fn new(
        assembly: &Assembly,
        elements: &[Vec<Element>],
        symmetric: bool,
        lists_nodes: bool,
    ) -> Self {
        let dimension = assembly.unknowns.len();
        let permanent = elements.concat();
        let chains: Vec<usize> = (assembly.rods.rods.iter().map(|rod| rod.first_node))
            .chain(assembly.rods.nodes..dimension / STRIDE)
            .collect();
        let ends = chains.iter().skip(1).copied().chain([dimension / STRIDE]);
        let unknowns = chains
            .iter()
            .zip(ends)
            .map(|(first, end)| STRIDE * first..STRIDE * end);
        let factor = BandedFactor::of_chains(dimension, unknowns);
        let ends = elements.iter().scan(0, |end, own| {
            *end += own.len();
            Some(*end)
        });
        Self {
            band: BandedSymmetric::new(dimension),
            factor,
            coupled: None,
            held: assembly.held.clone(),
            shared: assembly.joints.shared(),
            chains,
            lost_symmetry: false,
            symmetric,
            permanent_matrices: vec![ZERO; permanent.len()],
            permanent,
            ends: ends.collect(),
            closing: assembly.rods.elements.len(),
            active: Vec::new(),
            contact_elements: Vec::new(),
            candidate_elements: Vec::new(),
            first_node_element: 0,
            attached: AttachedNodes::of(assembly),
            turned_elements: TurnedElements::default(),
            curve_elements: CurveElements::default(),
            candidates_changed: true,
            lists_nodes,
            uses_band: true,
            spin_moment: vec![0.0; assembly.rods.nodes + assembly.rods.ghosts],
            isolated: Vec::new(),
        }
    }

    /// Target for the part of a term, given by its index.
    pub(crate) fn entries_of(&mut self, term: usize) -> Entries<'_> {
        let first = term.checked_sub(1).map_or(0, |last| self.ends[last]);
        Entries {
            own: first..self.ends[term],
            matrix: self,
        }
    }

    pub(crate) fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    pub(crate) fn clear(&mut self) {
        self.band.clear();
        self.isolated.clear();
        self.permanent_matrices.fill(ZERO);
        self.active.clear();
    }

    pub(crate) fn add_elastic(
        &mut self,
        rods: &ElasticRods,
        geometry: &RodGeometry,
        gradient: &mut [f64],
    ) {
        let closing = &mut self.permanent_matrices[..self.closing];
        rods.add_derivatives(
            geometry,
            gradient,
            &mut self.band,
            closing,
            &mut self.spin_moment,
        );
    }

    /// Converts the contributions of half vertices at joints to derivatives with respect to the
    /// unknowns, and adds the inertia of bodies.
    pub(crate) fn turn_frames(
        &mut self,
        assembly: &Assembly,
        unknowns: &[f64],
        stage: Option<&Stage>,
    ) {
        let elements = &mut self.permanent_matrices[..self.closing];
        let joints = &assembly.joints;
        joints.transform(unknowns, stage, &assembly.masses, elements);
    }

    /// Adds M/(hₐ h).
    pub(crate) fn add_masses(&mut self, assembly: &Assembly, stage: &Stage) {
        let per_step = 1.0 / stage.step;
        let per_acceleration_step = 1.0 / stage.acceleration_step;
        let columns = self.band.columns_mut();
        in_chunks(columns, &|first, columns| {
            for (column, mass) in columns.iter_mut().zip(&assembly.masses[first..]) {
                column[0] += mass * per_acceleration_step * per_step;
            }
        });
        let closing = &mut self.permanent_matrices[..self.closing];
        assembly.add_shared_masses(per_acceleration_step * per_step, columns, closing);
    }

    /// Sets the rotations of free bodies to those of the last evaluation, which was at `unknowns`.
    pub(crate) fn turn_bodies(&mut self, assembly: &Assembly, unknowns: &[f64]) {
        self.attached.turn(assembly, unknowns);
    }

    /// Vertices of free bodies.
    pub(crate) fn attached(&self) -> &AttachedNodes {
        &self.attached
    }

    pub(crate) fn add_contact(&mut self, contact: &ContactSystem) {
        self.update_elements(contact);
        if contact.curves().is_some() {
            let (first, active) = (self.permanent.len(), &mut self.active);
            self.curve_elements.add(contact, |element, matrix| {
                active.push((first + element, matrix))
            });
            return self.expect_contacts(contact);
        }
        let mut turned = contact.turned().iter().map(|one| one.bodies).peekable();
        let mut spun = contact.spun().iter();
        for (pair, jacobian) in contact.contacts().iter().zip(contact.jacobians()) {
            let spun = spun.next().and_then(Option::as_ref);
            if (turned.next_if_eq(&TurnedBodies::Pair(pair.candidate))).is_some() {
                continue;
            }
            let Some(element) = self.candidate_elements[pair.candidate] else {
                self.subtract_in_band(&pair.nodes[..pair.first_body], jacobian);
                continue;
            };
            let of_rods = match contact.is_of_rod(pair.nodes[3]) {
                true => &pair.nodes[..],
                false => &pair.nodes[..pair.first_body],
            };
            let matrix = match spun.and_then(|one| Some((one.bodies, one.jacobian.as_ref()?))) {
                Some((bodies, jacobian)) => self.attached.matrix_of_spun(of_rods, bodies, jacobian),
                None => self.attached.matrix_of(of_rods, jacobian),
            };
            self.active.push((self.permanent.len() + element, matrix));
        }
        let mut spun = contact.plane_spun().iter();
        for (touch, jacobian) in contact
            .plane_contacts()
            .iter()
            .zip(contact.plane_jacobians())
        {
            let spun = spun.next().and_then(Option::as_ref);
            let (plane, node) = (touch.plane, touch.node);
            if (turned.next_if_eq(&TurnedBodies::Plane { plane, node })).is_some() {
                continue;
            }
            if self.lists_nodes {
                let mut of_node = ZERO;
                for (row, own) in of_node.iter_mut().zip(jacobian) {
                    row[..3].copy_from_slice(own);
                }
                let matrix = match spun.and_then(|one| Some((one.bodies, one.jacobian.as_ref()?))) {
                    Some((bodies, jacobian)) => {
                        self.attached.matrix_of_spun(&[node], bodies, jacobian)
                    }
                    None => self.attached.matrix_of(&[node], &of_node),
                };
                let index = self.permanent.len() + self.first_node_element + touch.node;
                self.active.push((index, matrix));
            } else {
                let columns = self.band.columns_mut();
                for j in 0..3 {
                    for i in j..3 {
                        columns[STRIDE * touch.node + j][i - j] -= jacobian[i][j];
                    }
                }
            }
        }
        self.add_turned(contact);
        self.expect_contacts(contact);
    }

    /// Adds the contacts that turn edges.
    fn add_turned(&mut self, contact: &ContactSystem) {
        for one in contact.turned() {
            let first = self.permanent.len() + self.turned_elements.of(one.bodies);
            let matrices = matrices_of(one).into_iter().enumerate();
            self.active
                .extend(matrices.map(|(number, matrix)| (first + number, matrix)));
        }
    }

    /// Replaces the matrices of contacts by those of constraints.
    pub(crate) fn set_constraints(
        &mut self,
        contact: &ContactSystem,
        matrices: impl Iterator<Item = (ConstraintPlace, ConstraintMatrix)>,
    ) {
        self.update_elements(contact);
        let first = self.permanent.len();
        let (elements, first_node) = (&self.candidate_elements, self.first_node_element);
        let attached = &self.attached;
        self.active.clear();
        self.active.extend(matrices.map(|(place, matrix)| {
            let index = match place {
                ConstraintPlace::Candidate(candidate) => {
                    elements[candidate].expect("constraints have elements")
                }
                ConstraintPlace::Node(node) => first_node + node,
            };
            let matrix = matrix.over_unknowns(attached, contact, place);
            (first + index, matrix)
        }));
        self.expect_contacts(contact);
    }

    /// Reserves entries for the coupled contacts, if there are couplings, in a pattern to be found
    /// later. Call this before [`Self::factor`], even if contacts are added later.
    pub(crate) fn expect_contacts(&mut self, contact: &ContactSystem) {
        let couples =
            !self.active.is_empty() || !self.permanent.is_empty() || !self.shared.is_empty();
        if couples {
            self.update_elements(contact);
        }
    }

    /// Lists the elements of the coupled contacts, and drops the pattern if they differ from
    /// before.
    fn update_elements(&mut self, contact: &ContactSystem) {
        if !self.candidates_changed {
            return;
        }
        self.candidates_changed = false;
        let earlier = std::mem::take(&mut self.contact_elements);
        if contact.curves().is_some() {
            let nodes = self.held.len() / STRIDE;
            self.curve_elements = CurveElements::of(contact);
            self.contact_elements = self.curve_elements.elements(nodes);
            return self.forget_other_pattern(&earlier);
        }
        let with_obstacle = |pair: &CandidatePair| !contact.is_of_rod(pair.nodes[3]);
        let candidates = contact.candidates();
        let coupled = contact.coupled_pairs().iter();
        let attached = &self.attached;
        let elements = coupled.map(|candidate| attached.element_of(&candidates[*candidate].nodes));
        self.contact_elements.extend(elements);
        let first_edge = self.contact_elements.len();
        if !contact.surface().obstacles().is_empty() {
            let edges = contact.surface().rod_edges().iter();
            self.contact_elements
                .extend(edges.map(|edge| attached.element_of(&edge.nodes)));
        }
        self.first_node_element = self.contact_elements.len();
        if self.lists_nodes {
            let nodes = 0..self.held.len() / STRIDE;
            self.contact_elements
                .extend(nodes.map(|node| attached.element_of(&[node])));
        }
        let mut coupled = contact.coupled_pairs().iter().enumerate().peekable();
        self.candidate_elements.clear();
        for (candidate, pair) in candidates.iter().enumerate() {
            self.candidate_elements.push(if !with_obstacle(pair) {
                let own = coupled.next_if(|(_, coupled)| **coupled == candidate);
                own.map(|(element, _)| element)
            } else if pair.is_of_node() {
                self.lists_nodes
                    .then_some(self.first_node_element + pair.nodes[0])
            } else if pair.is_of_piece() {
                let [a, b, c, _] = pair.nodes;
                let has_element = self.lists_nodes || b != a + 1 || c != b + 1;
                has_element.then(|| {
                    self.contact_elements.push(attached.element_of(&[a, b, c]));
                    self.contact_elements.len() - 1
                })
            } else {
                let joins_neighbours = pair.nodes[1] == pair.nodes[0] + 1;
                let has_element = self.lists_nodes || !joins_neighbours;
                has_element.then_some(first_edge + pair.edges[0])
            });
        }
        if let Some(turning) = contact.turning_edges() {
            let nodes = self.lists_nodes.then_some(self.held.len() / STRIDE);
            let elements = &mut self.contact_elements;
            self.turned_elements = TurnedElements::list(elements, contact, &turning, nodes);
        }
        self.forget_other_pattern(&earlier);
    }

    /// Drops the pattern if the elements of contacts differ from those before.
    fn forget_other_pattern(&mut self, earlier: &[Element]) {
        if self.contact_elements != earlier {
            self.coupled = None;
            self.lost_symmetry = false;
        }
    }

    /// Subtracts the derivative of a force on one node, or on two or three successive nodes, from
    /// the band. The derivative must be symmetric.
    fn subtract_in_band(&mut self, nodes: &[usize], jacobian: &ElementMatrix) {
        let nodes = match nodes {
            [first, second] if first == second => &nodes[..1],
            _ => nodes,
        };
        let columns = self.band.columns_mut();
        for (n, column_node) in nodes.iter().enumerate() {
            for (m, row_node) in nodes.iter().enumerate().skip(n) {
                for j in 0..3 {
                    for i in if m == n { j } else { 0 }..3 {
                        let (row, column) = (STRIDE * row_node + i, STRIDE * column_node + j);
                        columns[column][row - column] -= jacobian[3 * m + i][3 * n + j];
                    }
                }
            }
        }
    }

    /// The diagonal block of the band for the position of a node, N/m.
    pub(crate) fn of_position(&self, node: usize) -> Matrix3 {
        Matrix3::from_fn(|row, column| self.band.get(STRIDE * node + row, STRIDE * node + column))
    }

    /// Transposes the Jacobian, before held unknowns are eliminated.
    pub(crate) fn transpose(&mut self) {
        let active = self.active.iter_mut().map(|(_, matrix)| matrix);
        for matrix in self.permanent_matrices.iter_mut().chain(active) {
            let own = *matrix;
            *matrix = std::array::from_fn(|row| std::array::from_fn(|column| own[column][row]));
        }
    }

    /// The whole Jacobian, before held unknowns are eliminated.
    pub(crate) fn whole(&self) -> WholeMatrix {
        let first = self.permanent.len();
        let contacts = (self.active.iter())
            .map(|(index, matrix)| (self.contact_elements[index - first], *matrix));
        let permanent = self.permanent.iter().copied();
        WholeMatrix {
            band: self.band.clone(),
            elements: (permanent.zip(self.permanent_matrices.iter().copied()))
                .chain(contacts)
                .collect(),
        }
    }

    /// Eliminates held unknowns from the band; the coupled system eliminates them by its pattern.
    pub(crate) fn hold(&mut self, held: &[bool]) {
        let mut end = 0;
        for run in held.chunk_by(|one, next| one == next) {
            let start = end;
            end += run.len();
            if run[0] {
                self.band.hold(start..end);
            }
        }
    }

    /// Replaces the row and column of an unknown that is eliminated in another way by those of the
    /// unit matrix; returns its diagonal entry in the last linearisation.
    pub(crate) fn isolate(&mut self, unknown: usize) -> f64 {
        let mut isolated = self.isolated.iter();
        if let Some((_, diagonal)) = isolated.find(|(other, _)| *other == unknown) {
            return *diagonal;
        }
        let diagonal = self.band.get(unknown, unknown);
        self.isolated.push((unknown, diagonal));
        self.band.hold(unknown..unknown + 1);
        diagonal
    }

    /// Adds to the diagonal of some free unknowns one value for positions and one for angles.
    pub(crate) fn shift(
        &mut self,
        unknowns: Range<usize>,
        shift: f64,
        spin_shift: f64,
        held: &[bool],
    ) {
        let columns = self.band.columns_mut();
        for k in unknowns {
            if !held[k] {
                columns[k][0] += if k % STRIDE == 3 { spin_shift } else { shift };
            }
        }
    }

    /// Updates which unknowns are held and which are shared, and the number of ghost edges.
    pub(crate) fn adapt(&mut self, assembly: &Assembly) {
        self.held.clone_from(&assembly.held);
        self.shared = assembly.joints.shared();
        let edges = assembly.rods.nodes + assembly.rods.ghosts;
        self.spin_moment.resize(edges, 0.0);
        self.forget_pattern();
    }

    /// Updates the unknowns that the terms couple, after the grouping of frames has changed.
    pub(crate) fn recouple(&mut self, assembly: &Assembly, elements: &[Vec<Element>]) {
        self.permanent = elements.concat();
        self.adapt(assembly);
    }

    /// Drops the pattern; it is determined again when there are couplings.
    pub(crate) fn forget_pattern(&mut self) {
        self.coupled = None;
        self.lost_symmetry = false;
        self.candidates_changed = true;
    }

    /// Prepares for other contacts: elements are listed again, and the pattern is kept if they are
    /// unchanged.
    pub(crate) fn expect_other_candidates(&mut self) {
        self.candidates_changed = true;
    }

    /// Factors the band of the rods alone, without coupling elements; returns its inertia unless
    /// it is singular.
    pub(crate) fn factor_rods(&mut self) -> Option<Inertia> {
        self.factor.factor(&self.band).ok()
    }

    /// The factors of the last [`Self::factor_rods`].
    pub(crate) fn rod_factor(&self) -> &BandedFactor {
        &self.factor
    }

    pub(crate) fn factor(&mut self) -> Result<Option<Inertia>, SingularMatrix> {
        self.uses_band =
            self.permanent.is_empty() && self.active.is_empty() && self.shared.is_empty();
        if self.uses_band {
            return self.factor.factor(&self.band).map(Some);
        }
        let coupled = match &mut self.coupled {
            Some(coupled) => coupled,
            none => {
                let mut elements = self.permanent.clone();
                elements.extend_from_slice(&self.contact_elements);
                none.insert(Islands::new(&Couplings {
                    dimension: self.held.len(),
                    elements: &elements,
                    held: &self.held,
                    shared: &self.shared,
                    chains: &self.chains,
                    symmetric: self.symmetric && !self.lost_symmetry,
                }))
            }
        };
        coupled.assemble(&self.band);
        for (index, matrix) in self.permanent_matrices.iter().enumerate() {
            coupled.add_element(index, matrix);
        }
        for (index, matrix) in &self.active {
            coupled.add_element(*index, matrix);
        }
        coupled.factor(&self.band, &mut self.factor)
    }

    /// Solves with the factors of the last [`Self::factor`].
    ///
    /// If strands of nearly parallel edges press on each other without friction, the pivots of the
    /// symmetric elimination become so small that rounding errors dominate. The general
    /// elimination, at twice the cost, then replaces it until the pattern changes.
    pub(crate) fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), SingularMatrix> {
        let Some(coupled) = self.coupled.as_mut().filter(|_| !self.uses_band) else {
            self.factor.solve(right_hand_side);
            return Ok(());
        };
        let solved = coupled.solve(right_hand_side, &self.factor);
        if solved.is_ok() || !self.symmetric || self.lost_symmetry {
            return solved;
        }
        self.lost_symmetry = true;
        self.coupled = None;
        self.factor()?;
        self.solve(right_hand_side)
    }

    /// The Jacobian over the free unknowns as a dense matrix.
    pub(crate) fn to_dense(&self) -> nalgebra::DMatrix<f64> {
        self.whole().to_dense(&self.held, &self.shared)
    }
}
