//! Resolves the probes of a scenario: names and places become rods, nodes and edges of the scene.

use super::places::{body_called, find_place};
use crate::run::probes::{
    ContactPartner, Limit, Probe, Probes, Quantity, STOPPED_BY, StopWhen, Summary,
};
use crate::run::{Observer, PreparedRun};
use crate::scenario::{self, Issue, Issues, KeyPath, Place, ProbeKind, Scenario, did_you_mean};
use rodlab_engine::mechanics::scene::{FreeBody, RodDescription, Scene};
use rodlab_files::results::{SummaryRow, series_columns};

/// Adds the probes of a scenario to the observers of a run.
///
/// # Errors
/// Rods, nodes, edges, clamps and planes that do not exist, columns that exist already, and probes
/// of an experiment without a simulation. Each fault names its key.
pub fn add(prepared: &mut PreparedRun, scenario: &Scenario) -> Result<(), Issues> {
    let mut issues = Issues::default();
    if scenario.probes.is_empty() && scenario.stop_when.is_none() {
        return Ok(());
    }
    if prepared.table.is_some() {
        let message = "this experiment fills a table and has no simulation to probe";
        issues.push(Issue::new(KeyPath::from("probes"), message));
        return Err(issues);
    }
    let mut probes = Vec::new();
    let mut taken = Taken::of(prepared);
    for (index, probe) in scenario.probes.iter().enumerate() {
        let key = KeyPath::from("probes").index(index);
        let found = resolve(probe, &prepared.scene, &key);
        match found.and_then(|probe| taken.take(probe, &key)) {
            Ok(probe) => probes.push(probe),
            Err(issue) => issues.push(issue),
        }
    }
    let condition = scenario.stop_when.as_ref();
    let stop_when = condition.map(|condition| stop_when(condition, &probes));
    let stop_when = match stop_when.transpose() {
        // A condition on a faulty probe is not an additional fault.
        Err(issue) if issues.0.is_empty() => {
            issues.push(issue);
            None
        }
        found => found.unwrap_or_default(),
    };
    issues.or_ok(())?;
    prepared
        .observers
        .push(Box::new(Probes::new(probes, stop_when)));
    Ok(())
}

/// The existing columns.
struct Taken {
    series: Vec<String>,
    summary: Vec<String>,
}

impl Taken {
    fn of(prepared: &PreparedRun) -> Self {
        let observed = prepared.observers.iter();
        let outcomes = prepared.observers.iter().flat_map(|one| one.outcomes().0);
        let outcomes = outcomes.map(|(name, _)| name);
        Self {
            series: (series_columns().into_iter())
                .chain(observed.flat_map(|one| Observer::columns(&**one)))
                .collect(),
            summary: (SummaryRow::columns().into_iter())
                .chain(outcomes)
                .chain([STOPPED_BY.to_owned()])
                .collect(),
        }
    }

    /// Reserves the columns of a probe.
    fn take(&mut self, probe: Probe, key: &KeyPath) -> Result<Probe, Issue> {
        for (columns, taken, table) in [
            (probe.columns(), &mut self.series, "series.csv"),
            (probe.summary_columns(), &mut self.summary, "summary.csv"),
        ] {
            if let Some(column) = columns.iter().find(|column| taken.contains(column)) {
                let message =
                    format!("{table} has a column `{column}` already; choose another name");
                return Err(Issue::new(key.key("name"), message));
            }
            taken.extend(columns);
        }
        Ok(probe)
    }
}

fn resolve(probe: &scenario::Probe, scene: &Scene, key: &KeyPath) -> Result<Probe, Issue> {
    let rods = Rods { scene, key };
    let quantity = match &probe.kind {
        ProbeKind::Position { rod, at } => Quantity::Position {
            node: rods.node(rod.as_ref(), *at)?,
        },
        ProbeKind::Displacement { rod, at } => {
            let (rod, along) = rods.place(rod.as_ref(), *at)?;
            Quantity::Displacement {
                node: rods.first_node(rod) + along,
                from: scene.rods[rod].centreline[along],
            }
        }
        ProbeKind::Velocity { rod, at } => Quantity::Velocity {
            node: rods.node(rod.as_ref(), *at)?,
        },
        ProbeKind::Reaction { rod, at } => rods.reaction(rod.as_ref(), *at)?,
        ProbeKind::Distance {
            rod,
            to_rod,
            at,
            to,
        } => rods.distance(rod.as_ref(), to_rod.as_ref(), at.zip(*to))?,
        ProbeKind::Tension { rod, at } => {
            let (rod, edge) = rods.place_or_largest(rod.as_ref(), *at, "edge")?;
            Quantity::Tension { rod, edge }
        }
        ProbeKind::Torsion { rod, at } => {
            let (rod, edge) = rods.place_or_largest(rod.as_ref(), *at, "edge")?;
            Quantity::Torsion { rod, edge }
        }
        ProbeKind::BendingMoment { rod, at } => {
            let (rod, node) = rods.place_or_largest(rod.as_ref(), *at, "node")?;
            Quantity::BendingMoment { rod, node }
        }
        ProbeKind::TwistingMoment { rod, at } => {
            let (rod, node) = rods.place_or_largest(rod.as_ref(), *at, "node")?;
            Quantity::TwistingMoment { rod, node }
        }
        ProbeKind::Curvature { rod, at } => {
            let (rod, node) = rods.place_or_largest(rod.as_ref(), *at, "node")?;
            Quantity::Curvature { rod, node }
        }
        ProbeKind::Twist { rod, at } => {
            let (rod, node) = rods.place_or_largest(rod.as_ref(), *at, "node")?;
            Quantity::Twist { rod, node }
        }
        ProbeKind::ContactForce {
            rod,
            from_rod,
            from_plane,
            from_obstacle,
        } => {
            let from = rods.partner(from_rod.as_ref(), *from_plane, from_obstacle.as_ref())?;
            let rod = match rod {
                Some(name) => rods.rod_or_body(name, "rod")?,
                None => rods.rod(None)?,
            };
            Quantity::ContactForce { rod, from }
        }
        ProbeKind::Body { body } => rods.body(body)?,
        ProbeKind::Energy { rod } => Quantity::Energy {
            rod: rods.rod(rod.as_ref())?,
        },
        ProbeKind::Writhe { rod } => Quantity::Writhe {
            rod: rods.rod(rod.as_ref())?,
        },
        ProbeKind::ArcLength { rod } => Quantity::ArcLength {
            rod: rods.rod(rod.as_ref())?,
        },
        ProbeKind::LinkingNumber { rod, to_rod } => {
            let one = rods.named(rod, "rod")?;
            let other = rods.named(to_rod, "to_rod")?;
            if one == other {
                let message = "a rod has no linking number with itself; ask for its writhe";
                return Err(Issue::new(key.key("to_rod"), message));
            }
            Quantity::LinkingNumber { rods: [one, other] }
        }
        ProbeKind::SpringForce { joint } => rods.spring(joint)?,
        ProbeKind::Tendon { tendon } => rods.tendon(tendon)?,
        ProbeKind::Sheath { sheath } => rods.sheath(sheath)?,
    };
    Ok(Probe {
        name: probe.name.clone(),
        quantity,
        summary: probe.summary.map(|summary| match summary {
            scenario::Summary::Last => Summary::Last,
            scenario::Summary::Max => Summary::Maximum,
            scenario::Summary::Min => Summary::Minimum,
            scenario::Summary::Mean => Summary::Mean,
        }),
    })
}

fn names_of<T>(all: &[T], name: fn(&T) -> &String) -> Vec<&str> {
    all.iter().map(|one| name(one).as_str()).collect()
}

/// The name that was probably meant, or all existing names.
fn help_with(name: &str, what: &str, names: &[&str]) -> String {
    let meant = did_you_mean(name, names.iter().copied());
    meant.unwrap_or_else(|| format!("the {what} are: {}", names.join(", ")))
}

/// The rods of a scene, as named by a probe.
struct Rods<'a> {
    scene: &'a Scene,
    /// The probe.
    key: &'a KeyPath,
}

impl Rods<'_> {
    fn named(&self, name: &str, key: &str) -> Result<usize, Issue> {
        let names = names_of(&self.scene.rods, |rod| &rod.name);
        let rod = names.iter().position(|known| *known == name);
        rod.ok_or_else(|| self.unknown("rod", "rods", name, &names, key))
    }

    /// A rod by its name, or the only rod.
    fn rod(&self, name: Option<&String>) -> Result<usize, Issue> {
        match (name, &self.scene.rods[..]) {
            (Some(name), _) => self.named(name, "rod"),
            (None, [_]) => Ok(0),
            (None, rods) => {
                let names = names_of(rods, |rod| &rod.name);
                let help = format!("the rods are: {}", names.join(", "));
                Err(Issue::new(self.key.clone(), "missing key `rod`").with_help(help))
            }
        }
    }

    fn first_node(&self, rod: usize) -> usize {
        let before = self.scene.rods[..rod].iter();
        before.map(|rod| rod.centreline.len()).sum()
    }

    fn along(&self, rod: usize, at: Place, key: &str, what: &str) -> Result<usize, Issue> {
        let description: &RodDescription = &self.scene.rods[rod];
        let nodes = description.centreline.len();
        let count = match what {
            "edge" if !description.closed => nodes - 1,
            _ => nodes,
        };
        find_place(at, count, what, description, &self.key.key(key))
    }

    /// Rod and node along it.
    fn place(&self, rod: Option<&String>, at: Place) -> Result<(usize, usize), Issue> {
        let rod = self.rod(rod)?;
        Ok((rod, self.along(rod, at, "at", "node")?))
    }

    fn node(&self, rod: Option<&String>, at: Place) -> Result<usize, Issue> {
        let (rod, along) = self.place(rod, at)?;
        Ok(self.first_node(rod) + along)
    }

    fn place_or_largest(
        &self,
        rod: Option<&String>,
        at: Option<Place>,
        what: &str,
    ) -> Result<(usize, Option<usize>), Issue> {
        let rod = self.rod(rod)?;
        let at = at.map(|at| self.along(rod, at, "at", what));
        let first = self.first_node(rod);
        Ok((rod, at.transpose()?.map(|along| first + along)))
    }

    fn reaction(&self, rod: Option<&String>, at: Place) -> Result<Quantity, Issue> {
        let scene = self.scene;
        if let Some(index) = rod.and_then(|name| body_called(name, scene)) {
            let body = index - scene.rods.len();
            let Some(_) = &scene.free_bodies[body].axle else {
                let name = &scene.free_bodies[body].name;
                let message = format!("nothing holds the free body `{name}`: it has no `axle`");
                return Err(Issue::new(self.key.key("rod"), message));
            };
            let before = scene.free_bodies[..body].iter().map(FreeBody::nodes);
            let node = self.first_node(scene.rods.len()) + before.sum::<usize>();
            return Ok(Quantity::Reaction { node });
        }
        let (rod, along) = self.place(rod, at)?;
        let mut clamps = self.scene.clamps.iter();
        if !clamps.any(|clamp| (clamp.rod, clamp.node) == (rod, along)) {
            let name = &self.scene.rods[rod].name;
            let message = format!("no clamp holds node {along} of rod `{name}`");
            return Err(Issue::new(self.key.key("at"), message));
        }
        Ok(Quantity::Reaction {
            node: self.first_node(rod) + along,
        })
    }

    /// A spring between nodes, or a force of a part of the scene.
    fn spring(&self, name: &str) -> Result<Quantity, Issue> {
        let scene = self.scene;
        let names: Vec<&str> = names_of(&scene.springs, |spring| &spring.name);
        if let Some(spring) = names.iter().position(|known| *known == name) {
            return Ok(Quantity::SpringForce { spring });
        }
        let force = scene.forces.iter().position(|force| force.name() == name);
        force
            .map(|force| Quantity::NodeForce { force })
            .ok_or_else(|| {
                self.unknown(
                    "spring between nodes",
                    "springs between nodes",
                    name,
                    &names,
                    "joint",
                )
            })
    }

    /// A rod, or a free body, which is counted after the rods.
    fn rod_or_body(&self, name: &str, key: &str) -> Result<usize, Issue> {
        let body = body_called(name, self.scene);
        body.map_or_else(|| self.named(name, key), Ok)
    }

    fn body(&self, name: &str) -> Result<Quantity, Issue> {
        let names: Vec<&str> = names_of(&self.scene.free_bodies, |body| &body.name);
        let body = self.part("body", "free bodies", name, &names)?;
        Ok(Quantity::Body { body })
    }

    fn tendon(&self, name: &str) -> Result<Quantity, Issue> {
        let names: Vec<&str> = names_of(&self.scene.tendons, |tendon| &tendon.name);
        let tendon = self.part("tendon", "tendons", name, &names)?;
        Ok(Quantity::Tendon { tendon })
    }

    fn sheath(&self, name: &str) -> Result<Quantity, Issue> {
        let names: Vec<&str> = names_of(&self.scene.sheaths, |sheath| &sheath.name);
        let sheath = self.part("sheath", "sheaths", name, &names)?;
        Ok(Quantity::Sheath { sheath })
    }

    /// Index of a part of the scene by its name.
    fn part(&self, one: &str, all: &str, name: &str, names: &[&str]) -> Result<usize, Issue> {
        let found = names.iter().position(|known| *known == name);
        found.ok_or_else(|| self.unknown(one, all, name, names, one))
    }

    /// The fault of a `name` that no `one` of `all` has.
    fn unknown(&self, one: &str, all: &str, name: &str, names: &[&str], key: &str) -> Issue {
        let help = match names {
            [] => format!("the scene has no {all}"),
            _ => help_with(name, all, names),
        };
        let message = format!("no {one} is called `{name}`");
        Issue::new(self.key.key(key), message).with_help(help)
    }

    fn distance(
        &self,
        rod: Option<&String>,
        to_rod: Option<&String>,
        nodes: Option<(Place, Place)>,
    ) -> Result<Quantity, Issue> {
        let one = self.rod(rod)?;
        let other = match to_rod {
            Some(name) => self.named(name, "to_rod")?,
            None => one,
        };
        let Some((at, to)) = nodes else {
            if one == other {
                let message = "a rod has no distance from itself; give the nodes `at` and `to`";
                return Err(Issue::new(self.key.key("to_rod"), message));
            }
            return Ok(Quantity::RodDistance { rods: [one, other] });
        };
        let at = self.along(one, at, "at", "node")?;
        let to = self.along(other, to, "to", "node")?;
        Ok(Quantity::NodeDistance {
            nodes: [self.first_node(one) + at, self.first_node(other) + to],
        })
    }

    /// Body that presses on a rod.
    fn partner(
        &self,
        rod: Option<&String>,
        plane: Option<usize>,
        obstacle: Option<&String>,
    ) -> Result<ContactPartner, Issue> {
        let fault = |key: &str, message: String| Err(Issue::new(self.key.key(key), message));
        if self.scene.contact.is_none() {
            let message = "there is no contact in this scenario: a table [contact] is missing";
            return fault("kind", message.to_owned());
        }
        let planes = self.scene.planes.len();
        if let Some(name) = obstacle {
            let names = names_of(&self.scene.obstacles, |obstacle| &obstacle.name);
            let Some(obstacle) = names.iter().position(|known| known == name) else {
                let message = match names.as_slice() {
                    [] => {
                        format!("there is no obstacle `{name}`: the scenario has no [[obstacles]]")
                    }
                    names => format!(
                        "there is no obstacle `{name}`; there are: {}",
                        names.join(", ")
                    ),
                };
                return fault("from_obstacle", message);
            };
            return Ok(ContactPartner::Obstacle(obstacle));
        }
        Ok(match (rod, plane) {
            (Some(name), _) => ContactPartner::Rod(self.rod_or_body(name, "from_rod")?),
            (None, Some(plane)) if plane < planes => ContactPartner::Plane(plane),
            (None, Some(plane)) => {
                let message = match planes {
                    0 => format!("there is no plane {plane}: the scenario has no [[planes]]"),
                    _ => format!("there is no plane {plane}; allowed: 0 to {}", planes - 1),
                };
                return fault("from_plane", message);
            }
            (None, None) => ContactPartner::Anything,
        })
    }
}

/// The condition on the named column, or on the only column of the named probe.
fn stop_when(condition: &scenario::StopWhen, probes: &[Probe]) -> Result<StopWhen, Issue> {
    let key = KeyPath::from("stop_when.probe");
    let columns: Vec<String> = probes.iter().flat_map(Probe::columns).collect();
    let column = match probes.iter().find(|probe| probe.name == condition.probe) {
        Some(probe) => match &probe.columns()[..] {
            [column] => Ok(column.clone()),
            several => {
                let help = format!("name one of them: {}", several.join(", "));
                Err(Issue::new(key, "this probe has several columns").with_help(help))
            }
        },
        None if columns.contains(&condition.probe) => Ok(condition.probe.clone()),
        None => {
            let message = format!("no probe has a column `{}`", condition.probe);
            let help = did_you_mean(&condition.probe, columns.iter().map(String::as_str));
            let help = help.unwrap_or_else(|| match columns.len() {
                0 => "there are no [[probes]]".to_owned(),
                _ => format!("the columns are: {}", columns.join(", ")),
            });
            Err(Issue::new(key, message).with_help(help))
        }
    };
    Ok(StopWhen {
        column: column?,
        limit: match (condition.above, condition.below) {
            (Some(limit), _) => Limit::Above(limit),
            (None, limit) => Limit::Below(limit.unwrap_or(f64::NEG_INFINITY)),
        },
    })
}
