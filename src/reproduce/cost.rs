//! Cost of a time step depending on the number of flagella, of rods in a heap, and of edges of one
//! rod.

use super::bundling::Bundling;
use super::cases::{Run, prepared_table};
use super::prelude::*;
use rodlab_lab::run::PreparedRun;
use toml::{Table, toml};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "cost",
    title: "Cost of a step over the number of flagella, of rods in a heap, of edges",
    recipe: &Tabled::new(Costly::all, Rows::Row(row), write, figures),
};

/// The run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Costly {
    /// Flagella in a viscous fluid.
    Flagella(Bundling),
    /// A heap with a number of rods, and its simulated time, s.
    Heap(usize, f64),
    /// A rod with a number of edges, and its simulated time, s.
    Rod(usize, f64),
}

/// Numbers of rods in a heap.
const RODS: [usize; 3] = [10, 50, 200];
/// Numbers of edges of a rod.
const EDGES: [usize; 5] = [100, 300, 1000, 3000, 10000];
/// Simulated time of the heaps, during which they collapse, and of the quick version, s.
const END_OF_HEAP: [f64; 2] = [0.2, 0.02];
/// Simulated time of the rod, and of the quick version, s.
const END_OF_ROD: [f64; 2] = [0.5, 0.02];

impl Costly {
    /// All runs of the page.
    pub fn all(quick: bool) -> Vec<Self> {
        let end = |ends: [f64; 2]| ends[usize::from(quick)];
        let flagella = Bundling::of_cost(quick).into_iter().map(Self::Flagella);
        let heaps = RODS.map(|rods| Self::Heap(rods, end(END_OF_HEAP)));
        let rods = EDGES.map(|edges| Self::Rod(edges, end(END_OF_ROD)));
        flagella.chain(heaps).chain(rods).collect()
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Flagella(_) => FLAGELLA,
            Self::Heap(..) => HEAPS,
            Self::Rod(..) => ONE_ROD,
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::Flagella(run) => run.flagella,
            Self::Heap(count, _) | Self::Rod(count, _) => *count,
        }
    }
}

/// Name of the family of flagella.
const FLAGELLA: &str = "flagella";
/// Name of the family of heaps.
const HEAPS: &str = "rods in a heap";
/// Name of the family of single rods.
const ONE_ROD: &str = "edges of a rod";

/// Rods of 20 edges in turns of the golden angle, with a vertical spacing of 2.25 mm, over a
/// square of 10 cm, as in `scenarios/pile.toml`.
fn heap(rods: usize, end: f64) -> Table {
    toml! {
        experiment = "scene"
        material = { youngs_modulus = "10 MPa", poissons_ratio = 0.5, density = 1000 }
        planes = [{ point = [0, 0, 0], normal = [0, 0, 1] }]
        loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
        contact = { model = "imc", friction = 0.3 }
        time = { step = 1e-3, end = end }
        [[rods]]
        count = rods
        name = "rod{i}"
        radius = 1e-3
        edges = 20
        shape = { kind = "straight", start = ["x - u", "y - v", "z"], end = ["x + u", "y + v", "z"] }
        [rods.let]
        x = "0.1*frac(i*0.7548776662466927)"
        y = "0.1*frac(i*0.5698402909980532)"
        z = "3e-3 + 2.25e-3*i"
        u = "0.05*cos(i*2.399963229728653)"
        v = "0.05*sin(i*2.399963229728653)"
    }
}

/// A clamped swinging rod.
fn rod(edges: usize, end: f64) -> Table {
    toml! {
        experiment = "scene"
        material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000 }
        clamps = [{ rod = "beam", at = "start" }]
        loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
        time = { step = "1 ms", end = end }
        [[rods]]
        name = "beam"
        radius = "5 mm"
        edges = edges
        shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
    }
}

impl Run for Costly {
    fn id(&self) -> String {
        match self {
            Self::Flagella(run) => run.id(),
            Self::Heap(rods, _) => format!("heap_{rods}"),
            Self::Rod(edges, _) => format!("rod_{edges}"),
        }
    }

    fn prepare(&self) -> PreparedRun {
        match self {
            Self::Flagella(run) => run.prepare(),
            Self::Heap(rods, end) => prepared_table(&self.id(), heap(*rods, *end), &[]),
            Self::Rod(edges, end) => prepared_table(&self.id(), rod(*edges, *end), &[]),
        }
    }

    fn end(&self) -> f64 {
        match self {
            Self::Flagella(run) => run.end(),
            Self::Heap(_, end) | Self::Rod(_, end) => *end,
        }
    }

    fn cost(&self) -> f64 {
        match self {
            Self::Flagella(run) => run.cost(),
            Self::Heap(rods, end) => 0.5 * end * *rods as f64 * (1.0 + *rods as f64 / 100.0),
            Self::Rod(edges, end) => 3e-3 * end * *edges as f64,
        }
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        match self {
            Self::Flagella(run) => Self::Flagella(run.shortened()),
            Self::Heap(rods, _) => Self::Heap(*rods, 2e-3),
            Self::Rod(edges, _) => Self::Rod(*edges, 2e-3),
        }
    }
}

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
struct Row {
    kind: String,
    count: usize,
    nodes: usize,
    status: String,
    steps: u64,
    steps_with_contact: u64,
    iterations_per_step: f64,
    cpu_time_per_step_s: Option<f64>,
    wall_time_per_step_s: f64,
}

/// Writes the table and the figure.
fn write(page: &mut Page, _: &[Case<Costly>], rows: &[Row]) -> Result<()> {
    page.text(
        "Steps of 1 ms. Flagella turn in a fluid from rest, with the search for contacts but \
         before they meet. Rods of 20 edges fall on a floor and on each other, with friction 0.3 \
         (the first steps of `scenarios/pile.toml`). One rod swings from a clamp. The table gives \
         the number of steps with contacts. Times are those of a whole run divided by its steps: \
         processor time of all threads, including the set-up and the first preconditioner of the \
         fluid.",
    );
    page.table(columns! { row in rows;
        "Number" => row.count.to_string(),
        "of" => row.kind.clone(),
        "Nodes" => row.nodes.to_string(),
        "Steps" => row.steps.to_string(),
        "with contact" => row.steps_with_contact.to_string(),
        "Iterations per step" => number(row.iterations_per_step, 2),
        "Processor time per step in ms" => number(row.cpu_time_per_step_s.map(|time| 1e3 * time), 2),
        "Wall time per step in ms" => number(1e3 * row.wall_time_per_step_s, 2),
    });
    Ok(())
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let families = [
        (FLAGELLA, "flagella in a fluid"),
        (HEAPS, "collapsing heap of rods"),
        (ONE_ROD, "one rod"),
    ];
    let curves = families.map(|(kind, name)| {
        let rows = rows.iter().filter(|row| row.kind == kind);
        let time = |row: &Row| row.cpu_time_per_step_s.map(|time| 1e3 * time);
        curve(name, rows, |row| (row.nodes as f64, time(row))).looking(Look::Marked)
    });
    let plot = plot("Processor time of a step in ms", curves);
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    vec![PageFigure::new(
        "cost",
        "Processor time of a step of 1 ms over the number of nodes",
        styled_line_plots([plot], "Number of nodes", style),
    )]
}

fn row(case: &Case<Costly>) -> Row {
    let outcome = &case.record.outcome;
    let steps = outcome.steps as f64;
    Row {
        kind: case.run.kind().into(),
        count: case.run.count(),
        nodes: case.manifest.rods.iter().map(|rod| rod.nodes).sum(),
        status: case.status().into(),
        steps: outcome.steps,
        steps_with_contact: outcome.steps_with_contact,
        iterations_per_step: outcome.newton_iterations as f64 / steps,
        cpu_time_per_step_s: case.record.cpu_time.map(|time| time / steps),
        wall_time_per_step_s: case.record.wall_time / steps,
    }
}
