//! Figure 5.4: allowed positions of a gripper above a straight line.

use super::figure_5_5::largest_sideways_at;
use super::prelude::*;
use super::sideways_push::{SUSPENDED, SidewaysPush, stretch_stiffness};
use rodlab_files::figure::{ColourField, Figure, LinePlot};
use rodlab_planning::plan::grasp::{
    FreeGrasp, Grasp, GraspBound, GraspProblem, GraspSolver, PlanarGrasp, SidewaysAnswer,
    free_grasps, grasp_region, rod_along_ray,
};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig5.4",
    title: "Figure 5.4: where a gripper may be above a straight line",
    recipe: &Tabled::new(SidewaysPush::of_figure_5_5, Rows::All(rows), write, figures),
};

/// Step between rays, degrees above the table.
const RAY_STEP: usize = 3;
/// Number of grasps along each ray.
const GRASPS_PER_RAY: usize = 9;
/// Largest force of the table, EI/L_gb², of the shown grasps without a contact moment.
const LARGEST_FORCE: f64 = 2.5;
/// Step between these forces, EI/L_gb².
const FORCE_STEP: f64 = 0.05;
/// The push of thesis Fig. 5.4d.
const PUSH: f64 = 0.12;
/// Number of edges of drawn rods.
const EDGES: usize = 200;
/// Ratio of displacement to push above which grasps have the last colour.
const LARGEST_DISPLACEMENT: f64 = 3.0;

/// A row of the CSV file; lengths in L_gb, forces in EI/L_gb².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    /// "ray", or "free" for grasps without a contact moment.
    of: String,
    x: f64,
    z: f64,
    gripper_degrees: f64,
    force_x: f64,
    force_z: f64,
    contact_moment: f64,
    lowest: f64,
    /// "pull", "moment" or "table" at the ends of a ray.
    bound: Option<String>,
    unstable_modes: usize,
    sideways_over_push: f64,
}

impl Row {
    fn new(of: &str, grasp: &PlanarGrasp, answer: &SidewaysAnswer, bound: Option<&str>) -> Self {
        Self {
            of: of.into(),
            x: grasp.gripper[0],
            z: grasp.gripper[1],
            gripper_degrees: grasp.angle.to_degrees(),
            force_x: grasp.contact_force[0],
            force_z: grasp.contact_force[1],
            contact_moment: grasp.contact_moment,
            lowest: grasp.lowest,
            bound: bound.map(str::to_owned),
            unstable_modes: answer.unstable_modes,
            sideways_over_push: answer.largest_over_push,
        }
    }

    fn force(&self) -> f64 {
        libm::hypot(self.force_x, self.force_z)
    }
}

/// Writes table and figures.
fn write(page: &mut Page, cases: &[Case<SidewaysPush>], rows: &[Row]) -> Result<()> {
    page.text(&format!(
        "Positions of the gripper above a straight line (thesis 5.3.2, Algorithm 6) for l̄_s = {SUSPENDED} and k̄_s = \
         {:.0}, the green rod of Tab. 5.1, by the equations of the suspended rod. Lengths are in L_gb, forces in \
         EI/L_gb²; the thesis' F̄ = F h²/EI is (h/L_gb)² = 1/400 of them.",
        stretch_stiffness()
    ));
    page.text(
        "Assumptions that the thesis does not state: Algorithm 6 gives its solver a position and \
         no direction, and Eq. 5.3 requires zero bending at the gripper. Here the contact node is \
         clamped level on the table, and the rod turns freely in the gripper at its position; α \
         follows. Then there is a region with the two bounds of Fig. 5.4b: outside, F_z < 0; \
         inside, the rod touches the table. Such a clamp carries a moment M(0), which a lying rod \
         of κ̄ = 0 cannot carry. F = 0 (Eq. 5.8) is found once, on the outer boundary, with the \
         moment of the last row: a rod cannot lie straight there. Grasps with M(0) = 0 form a \
         curve, which is the inner boundary of the region up to rays of about 108° and continues \
         from there among rods that lean back over the contact node; on it the axial force F_x, \
         which friction must hold, vanishes twice: the local minima 1 and 2, the optimal grasps.",
    );
    let minima = minima();
    let simulated = |minimum: usize| {
        let case = cases.iter().find(|case| case.run.minimum == minimum);
        case.map_or(Ok(None), |case| largest_sideways_at(case, PUSH))
    };
    let line = |name: String, grasp: Option<PlanarGrasp>, ways: String, sideways: String| {
        let of = |value: fn(PlanarGrasp) -> f64, decimals| number(grasp.map(value), decimals);
        vec![
            name,
            of(|grasp| grasp.gripper[0], 4),
            of(|grasp| grasp.gripper[1], 4),
            of(|grasp| grasp.angle.to_degrees(), 2),
            of(|grasp| grasp.contact_force[0].abs(), 4),
            of(|grasp| grasp.contact_force[1], 4),
            of(|grasp| grasp.contact_moment.abs(), 4),
            ways,
            sideways,
        ]
    };
    let mut lines = Vec::new();
    for (index, grasp) in minima.iter().enumerate() {
        let found = free(&[grasp.contact_force.z])
            .first()
            .map(|free| free.grasp);
        let name = format!("local minimum {}", index + 1);
        let sideways = number(simulated(index + 1)?, 2);
        lines.push(line(
            name,
            found,
            grasp.unstable_modes.to_string(),
            sideways,
        ));
    }
    if let Some(mut grasp) = without_force() {
        grasp.contact_force[1] = grasp.contact_force[1].abs();
        let name = "F = 0 with a moment".into();
        lines.push(line(name, Some(grasp), "–".into(), "–".into()));
    }
    page.lines(
        &[
            "grasp",
            "x̄",
            "z̄",
            "α in °",
            "\\|F_x\\|",
            "F_z",
            "M(0)",
            "unstable modes",
            "sideways at Δȳ = 0.12, simulated",
        ],
        &lines,
    );
    page.text(&verdict(rows));
    Ok(())
}

fn free(forces: &[f64]) -> Vec<FreeGrasp> {
    let found = free_grasps(SUSPENDED, stretch_stiffness(), forces);
    found.expect("a length and a stiffness in range")
}

fn rows(_: &[Case<SidewaysPush>]) -> Result<Vec<Row>> {
    let rays: Vec<f64> = (1..180 / RAY_STEP)
        .map(|ray| ((RAY_STEP * ray) as f64).to_radians())
        .collect();
    let region = grasp_region(SUSPENDED, stretch_stiffness(), &rays);
    let region = region.expect("a length and a stiffness in range");
    let mut rows = Vec::new();
    for stretch in &region {
        let grasps = stretch.grasps(GRASPS_PER_RAY);
        for (index, (grasp, answer)) in grasps.iter().enumerate() {
            let bound = match index {
                0 => Some(stretch.bounds[0]),
                _ if index + 1 == GRASPS_PER_RAY => Some(stretch.bounds[1]),
                _ => None,
            };
            let bound = bound.map(|bound| match bound {
                GraspBound::Pull => "pull",
                GraspBound::Moment => "moment",
                GraspBound::Table => "table",
            });
            rows.push(Row::new("ray", grasp, answer, bound));
        }
    }
    let count = (LARGEST_FORCE / FORCE_STEP).round() as usize;
    let forces: Vec<f64> = (2..=count).map(|index| FORCE_STEP * index as f64).collect();
    let free = free(&forces);
    rows.extend(
        free.iter()
            .map(|free| Row::new("free", &free.grasp, &free.answer, None)),
    );
    Ok(rows)
}

/// Local minima 1 and 2: the gentle grasp, and the one of the others with the fewest unstable
/// modes.
fn minima() -> [Grasp; 2] {
    let problem = GraspProblem::new(SUSPENDED, 0.0, stretch_stiffness());
    let problem = problem.expect("a length and a stiffness in range");
    let found = GraspSolver::new().all_centrelines(&problem, 1);
    let mut found = found.expect("there are planar grasps of this length");
    let others = (1..found.len()).filter(|&index| found[index].0.is_feasible());
    let second = others.min_by_key(|&index| found[index].0.unstable_modes);
    let second = second.expect("there are several grasps of this length");
    let second = found.swap_remove(second).0;
    [found.swap_remove(0).0, second]
}

/// The grasp of the outer boundary whose axial force also vanishes.
fn without_force() -> Option<PlanarGrasp> {
    let outer = |direction: f64| {
        let region = grasp_region(SUSPENDED, stretch_stiffness(), &[direction]).ok()?;
        Some(region.first()?.ends[0])
    };
    let [mut flat, mut steep] = [80f64, 90.0].map(f64::to_radians);
    let mut found = outer(flat)?;
    for _ in 0..20 {
        let middle = 0.5 * (flat + steep);
        found = outer(middle)?;
        if found.contact_force[0] < 0.0 {
            flat = middle;
        } else {
            steep = middle;
        }
    }
    Some(found)
}

fn verdict(rows: &[Row]) -> String {
    let stable = rows
        .iter()
        .filter(|row| row.of == "free" && row.unstable_modes == 0);
    let last = largest(stable.map(|row| row.force_z));
    format!(
        "Of the grasps without a contact moment those with F_z up to {last:.2} are stable, so that \
         local minimum 1 is stable and local minimum 2 is not: by linear theory, a rod at local \
         minimum 2 gives way without a push. The sideways response to a small push of the gripper \
         (Fig. 5.4d) is the largest displacement over the push, by the second variation of its \
         energy; near the boundary of the unstable grasps it grows without bound."
    )
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let force = ColourField {
        label: "F in EI/L_{gb}^{2}".into(),
        scale: AxisScale::Logarithmic,
        ..ColourField::default()
    };
    let displacement = ColourField {
        label: "Δq/Δy".into(),
        most: Some(LARGEST_DISPLACEMENT),
        ..ColourField::default()
    };
    vec![
        PageFigure::new(
            "fig5.4_rods",
            "Rods of the local minima, and of grasps along a ray of 60°: in region I, in the region, in region III",
            rods(),
        ),
        PageFigure::new(
            "fig5.4_force",
            "The region of grasps and the force of the lying part; the grasps without a contact moment as a line",
            region(rows, force, |row| row.force(), |_| false),
        ),
        PageFigure::new(
            "fig5.4_sideways",
            "Largest sideways displacement of the rod over that of its gripper, and grasps that are unstable",
            region(
                rows,
                displacement,
                |row| row.sideways_over_push,
                |row| row.unstable_modes > 0,
            ),
        ),
    ]
}

/// Grasps coloured by a quantity, with the unstable grasps and the line of the grasps without a
/// contact moment.
fn region(
    rows: &[Row],
    field: ColourField,
    value: fn(&Row) -> f64,
    is_unstable: fn(&Row) -> bool,
) -> Figure {
    let rays = |wanted: bool| {
        let rays = rows.iter().filter(|row| row.of == "ray");
        rays.filter(move |row| is_unstable(row) == wanted)
    };
    let places = |name: &str, rows: Vec<&Row>, look: Look| {
        curve(name, rows, |row| (row.x, row.z)).looking(look)
    };
    let stable = rays(false).map(|row| [row.x, row.z, value(row)]);
    let field = ColourField {
        values: stable.collect(),
        ..field
    };
    let unstable: Vec<&Row> = rays(true).collect();
    let mut curves = Vec::new();
    if !unstable.is_empty() {
        curves.push(places("unstable", unstable, Look::OpenMarks).like(6));
    }
    let free = rows.iter().filter(|row| row.of == "free").collect();
    curves.push(places("M(0) = 0", free, Look::Dashed).like(1));
    let minima = curve("local minima 1 (right) and 2", minima(), |grasp| {
        (grasp.position.x, grasp.position.z)
    });
    curves.push(minima.looking(Look::Marks).like(1));
    let plot = LinePlot {
        field: Some(field),
        ..plot("z/L_{gb}", curves)
    };
    plot_to_scale(plot, "x/L_{gb}")
}

fn rods() -> Figure {
    let problem = GraspProblem::new(SUSPENDED, 0.0, stretch_stiffness());
    let problem = problem.expect("a length and a stiffness in range");
    let found = GraspSolver::new().all_centrelines(&problem, EDGES);
    let found = found.expect("there are planar grasps of this length");
    let mut curves = Vec::new();
    for (index, minimum) in minima().iter().enumerate() {
        let same = |(grasp, _): &&(Grasp, Vec<_>)| {
            (grasp.contact_force - minimum.contact_force).norm() < 1e-9
        };
        if let Some((_, nodes)) = found.iter().find(same) {
            let name = format!("local minimum {}", index + 1);
            curves.push(curve(name, nodes, |node| (node.x, node.z)));
        }
    }
    let direction = 60f64.to_radians();
    let region = grasp_region(SUSPENDED, stretch_stiffness(), &[direction]);
    let region = region.expect("a length and a stiffness in range");
    if let Some(stretch) = region.first() {
        let [outer, inner] = stretch
            .ends
            .map(|end| libm::hypot(end.gripper[0], end.gripper[1]));
        for (name, distance) in [
            ("region I", 1.05 * outer),
            ("between the boundaries", 0.5 * (outer + inner)),
            ("region III", 0.6 * inner),
        ] {
            let rod = rod_along_ray(SUSPENDED, stretch_stiffness(), [direction, distance], EDGES);
            if let Ok(Some(places)) = rod {
                let rod = curve(name, places, |[x, z]| (x, z));
                curves.push(rod.looking(Look::Dashed));
            }
        }
    }
    to_scale(curves)
}

fn to_scale(curves: Vec<Curve>) -> Figure {
    let plot = plot("z/L_{gb}", curves);
    plot_to_scale(plot, "x/L_{gb}")
}
