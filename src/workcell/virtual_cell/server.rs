//! The server: clients, their goals, reports and pictures, and the clock of the cell.

use super::arm::{Ended, Refusal};
use super::camera::PictureTaker;
use super::connection::Connection;
use super::fault::FaultKind;
use super::goal_status::GoalLog;
use super::message::{
    GoalName, Request, Verdict, complaint, opening, published, stamp, trajectory,
};
use super::settings::Settings;
use super::sheet::SimulatedSheet;
use super::simulated_cell::{Event, STEP, SimulatedCell};
use super::topics::{CLOCK, GRIP, MOTION, Topics};
use crate::cell::Cell;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_robot::RosVersion;
use serde_json::json;
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener};
use std::time::{Duration, Instant};

/// Largest number of clients at a time.
const MOST_CLIENTS: usize = 16;
/// Longest time for which the server advances the cell before it reads messages.
const WORK: Duration = Duration::from_millis(5);
/// Time for which the server sleeps when idle.
const REST: Duration = Duration::from_millis(1);
/// Largest delay of the simulation, s of wall time; a greater delay is not made up.
const BEHIND: f64 = 0.05;
/// Largest lead, s of the cell's clock, over the time that its clients have seen; a third of the
/// allowed delay of an arm.
const LEAD: f64 = 0.1;
/// Time between reports: on the cell's clock, s, and least and greatest wall time.
const REPORT: (f64, Duration, Duration) =
    (0.01, Duration::from_millis(2), Duration::from_millis(40));
/// Time between lists of goals.
const STATUS: Duration = Duration::from_millis(200);
/// Longest wait for the answer of a client. After it the clock no longer waits for the client,
/// until the client answers again.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between pictures, s of the cell's clock.
const PICTURE: f64 = 0.1;

/// Failure of a virtual cell.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The cell cannot be simulated.
    #[error("{0}")]
    Cell(String),
    /// The server cannot listen on the address.
    #[error("{address}: cannot listen on this address: {error}")]
    Address {
        /// The address.
        address: SocketAddr,
        /// Error of the system.
        error: io::Error,
    },
    /// The rod or the sheet cannot be simulated any more.
    #[error("the simulation of the objects on the table failed: {0}")]
    Rod(#[from] SimulationError),
}

/// An active goal with its client.
struct UnderWay {
    name: GoalName,
    client: u64,
}

/// An action: its active goal, if there is one, and recently ended goals.
#[derive(Default)]
struct Action {
    goal: Option<UnderWay>,
    ended: GoalLog,
}

/// A virtual cell with its server.
pub struct VirtualCell {
    listener: TcpListener,
    token: Option<String>,
    rate: f64,
    cell: SimulatedCell,
    topics: Topics,
    clients: Vec<Connection>,
    next_client: u64,
    /// The client that controls each arm.
    leaders: Vec<Option<u64>>,
    /// The actions of each arm and of its gripper.
    actions: Vec<[Action; 2]>,
    pictures: Option<PictureTaker>,
    last_picture: f64,
    /// Longest wait for the answer of a client.
    patience: Duration,
    /// Subscribers at the start of the picture in progress.
    watchers: Vec<u64>,
    last_report: (f64, Instant),
    last_status: Instant,
}

impl VirtualCell {
    /// Listens for clients of a cell.
    ///
    /// # Errors
    /// An arm has a driver other than rosbridge, the picture of the camera is too large, or the
    /// address is in use.
    pub fn new(cell: &Cell, settings: Settings) -> Result<Self, ServeError> {
        let topics = Topics::of(cell).map_err(ServeError::Cell)?;
        let camera = cell.camera.as_ref();
        let pictures = camera.map(|camera| PictureTaker::new(camera.seeing(cell.table_height())));
        let unusable = |error| ServeError::Address {
            address: settings.address,
            error,
        };
        let listener = TcpListener::bind(settings.address).map_err(unusable)?;
        listener.set_nonblocking(true).map_err(unusable)?;
        let parts = topics.arms.len();
        Ok(Self {
            listener,
            token: settings.token.clone(),
            rate: settings.rate,
            topics,
            clients: Vec::new(),
            next_client: 1,
            leaders: vec![None; parts],
            actions: (0..parts).map(|_| Default::default()).collect(),
            pictures,
            last_picture: f64::NEG_INFINITY,
            patience: PATIENCE,
            watchers: Vec::new(),
            last_report: (f64::NEG_INFINITY, Instant::now()),
            last_status: Instant::now(),
            cell: SimulatedCell::new(cell, settings),
        })
    }

    /// Waits longer for clients than for those of other processes: for a client that shares the
    /// processors with the simulation.
    pub(super) fn wait_for_clients(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// Address on which the server listens.
    ///
    /// # Errors
    /// The operating system does not report the address.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// The sheet on the table.
    pub fn sheet(&self) -> Option<&SimulatedSheet> {
        self.cell.sheet()
    }

    /// Serves until an interruption is requested.
    ///
    /// # Errors
    /// The simulation of the objects on the table failed.
    pub fn serve(&mut self, is_interrupted: &dyn Fn() -> bool) -> Result<(), ServeError> {
        let mut since = Instant::now();
        let mut began = self.cell.time();
        while !is_interrupted() {
            self.listen();
            let clock = began + self.rate * since.elapsed().as_secs_f64();
            let patience = self.patience;
            let seen = self
                .clients
                .iter()
                .filter_map(|client| client.seen(patience));
            let target = seen.fold(clock, |target, seen| target.min(seen + LEAD));
            let target = target.min(self.end_of_picture());
            let work = Instant::now();
            let mut is_idle = true;
            while self.cell.time() + STEP <= target && work.elapsed() < WORK {
                is_idle = false;
                for event in self.cell.advance()? {
                    self.tell(event);
                }
            }
            // A delay that cannot be made up is dropped: the clock of the cell is then late.
            if clock - self.cell.time() > self.rate * BEHIND {
                (since, began) = (Instant::now(), self.cell.time());
            }
            self.report();
            self.report_goals();
            self.take_pictures();
            self.clients.iter_mut().for_each(Connection::flush);
            if is_idle {
                std::thread::sleep(REST);
            }
        }
        Ok(())
    }

    /// Accepts clients, reads their messages, and stops the arms of clients that have disconnected.
    fn listen(&mut self) {
        for _ in 0..MOST_CLIENTS {
            if self.clients.len() >= MOST_CLIENTS && !self.has_idle_client() {
                break;
            }
            match self.listener.accept() {
                Ok((stream, _)) => {
                    if self.clients.len() >= MOST_CLIENTS {
                        self.drop_idle_client();
                    }
                    let id = self.next_client;
                    self.next_client += 1;
                    let token = self.token.as_deref();
                    self.clients.extend(Connection::accept(id, stream, token));
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => {
                    tracing::warn!("cannot accept a client: {error}");
                    break;
                }
            }
        }
        for index in 0..self.clients.len() {
            for text in self.clients[index].receive() {
                self.hear(index, &text);
            }
        }
        let gone = self.clients.extract_if(.., |client| client.is_closed());
        let gone: Vec<u64> = gone.map(|client| client.id).collect();
        for (arm, leader) in self.leaders.iter_mut().enumerate() {
            if leader.take_if(|leader| gone.contains(leader)).is_some() {
                tracing::info!(
                    "the client that controlled {} has disconnected",
                    self.topics.arms[arm].name
                );
                let action = &mut self.actions[arm][MOTION];
                if let Some(goal) = action.goal.take() {
                    action.ended.note(&goal.name.id, &Verdict::Cancelled);
                    self.cell.stop(arm);
                }
            }
        }
    }

    /// Clients that neither control an arm nor do anything else, with their idle times.
    fn idle_clients(&self) -> impl Iterator<Item = (usize, Duration)> {
        let clients = self.clients.iter().enumerate();
        let is_busy = |id: u64| {
            let mut goals = self
                .actions
                .iter()
                .flatten()
                .filter_map(|action| action.goal.as_ref());
            self.leaders.contains(&Some(id)) || goals.any(|goal| goal.client == id)
        };
        clients.filter_map(move |(index, client)| {
            let idle = client.idle().filter(|_| !is_busy(client.id))?;
            Some((index, idle))
        })
    }

    fn has_idle_client(&self) -> bool {
        self.idle_clients().next().is_some()
    }

    /// Disconnects the client that has been idle for longest.
    fn drop_idle_client(&mut self) {
        if let Some((index, _)) = self.idle_clients().max_by_key(|(_, idle)| *idle) {
            self.clients.remove(index);
        }
    }

    fn hear(&mut self, index: usize, text: &str) {
        let request = Request::read(text);
        let goal = match &request {
            Ok(Request::Goal { id, .. }) => Some(id.clone()),
            _ => None,
        };
        let answer = match request {
            Ok(Request::Subscribe(topic, wish)) => {
                let known = self.topics.know(&topic);
                known.and_then(|()| self.clients[index].subscribe(topic, wish))
            }
            Ok(Request::Unsubscribe(topic, id)) => {
                self.clients[index].unsubscribe(&topic, id.as_deref());
                Ok(())
            }
            Ok(Request::Goal { action, id, body }) => self.take(index, &action, id, &body),
            Ok(Request::Cancel { action, id }) => self.cancel(index, &action, &id),
            Ok(Request::Nothing) => Ok(()),
            Err(words) => Err(words),
        };
        if let Err(words) = answer {
            self.clients[index].send(&complaint(&words, goal.as_deref()));
        }
    }

    /// Accepts a goal. One client at a time controls an arm, until it disconnects.
    fn take(
        &mut self,
        index: usize,
        action: &str,
        id: String,
        body: &serde_json::Value,
    ) -> Result<(), String> {
        let client = self.clients[index].id;
        let (arm, which) = self.topics.action(action)?;
        let known = &self.topics.arms[arm];
        let moving = self.actions[arm][MOTION].goal.as_ref();
        let leader = match which {
            MOTION => self.leaders[arm],
            _ => moving.map(|goal| goal.client),
        };
        if leader.is_some_and(|leader| leader != client) {
            return Err(format!("{} is controlled by another client", known.name));
        }
        let name = GoalName {
            version: known.version,
            action: action.to_owned(),
            id,
        };
        let goal = UnderWay { name, client };
        let taken = match which {
            MOTION => {
                let trajectory = trajectory(body).map_err(Refusal::invalid);
                trajectory.and_then(|trajectory| self.cell.follow(arm, trajectory))
            }
            _ => {
                let taken = opening(body).and_then(|opening| self.cell.grip(arm, opening));
                taken.map_err(Refusal::invalid)
            }
        };
        if let Err(refusal) = taken {
            self.end(arm, which, &goal, &refusal.into());
            return Ok(());
        }
        if which == MOTION {
            self.leaders[arm] = Some(client);
            self.clients[index].send(&goal.name.feedback());
        }
        if let Some(before) = self.actions[arm][which].goal.replace(goal) {
            self.end(arm, which, &before, &Verdict::Cancelled);
        }
        Ok(())
    }

    fn cancel(&mut self, index: usize, action: &str, id: &str) -> Result<(), String> {
        let (arm, which) = self.topics.action(action)?;
        let client = self.clients[index].id;
        let is_meant =
            |goal: &mut UnderWay| goal.client == client && (id.is_empty() || goal.name.id == id);
        if let Some(goal) = self.actions[arm][which].goal.take_if(is_meant) {
            if which == MOTION {
                self.cell.stop(arm);
            }
            self.end(arm, which, &goal, &Verdict::Cancelled);
        }
        Ok(())
    }

    /// Ends a goal of an arm or its gripper: reports the result to the client, and lists the goal
    /// as ended.
    fn end(&mut self, arm: usize, which: usize, goal: &UnderWay, verdict: &Verdict) {
        self.actions[arm][which].ended.note(&goal.name.id, verdict);
        send_to(&mut self.clients, goal.client, &goal.name.result(verdict));
    }

    /// Ends the active goal of an arm or its gripper.
    fn end_under_way(&mut self, arm: usize, which: usize, verdict: &Verdict) {
        if let Some(goal) = self.actions[arm][which].goal.take() {
            self.end(arm, which, &goal, verdict);
        }
    }

    /// Reports the events of a step.
    fn tell(&mut self, event: Event) {
        match event {
            Event::Arm(arm, ended) => {
                let verdict = match ended {
                    Ended::There => Verdict::Succeeded,
                    Ended::Broken(refusal) => refusal.into(),
                };
                self.end_under_way(arm, MOTION, &verdict);
            }
            Event::Gripper(arm) => self.end_under_way(arm, GRIP, &Verdict::Succeeded),
            Event::Fault(kind) => {
                tracing::warn!("{kind}, injected");
                match kind {
                    FaultKind::DropLink => self.clients.iter_mut().for_each(Connection::cut),
                    FaultKind::LoseCamera => self.pictures = None,
                    FaultKind::FreezeJoint | FaultKind::SlipGrasp => {}
                }
            }
        }
    }

    /// Publishes the time and the joint positions.
    fn report(&mut self) {
        let (time, told) = self.last_report;
        let now = self.cell.time();
        let (interval, least, most) = REPORT;
        let is_due = now - time >= interval - 1e-9 && told.elapsed() >= least;
        if !is_due && told.elapsed() < most {
            return;
        }
        self.last_report = (now, Instant::now());
        let version = self.topics.version;
        let clock = published(CLOCK, json!({ "clock": stamp(version, now) }));
        let mut reports = vec![(CLOCK.to_owned(), clock)];
        for (index, (known, arm)) in self.topics.arms.iter().zip(self.cell.arms()).enumerate() {
            let names = arm.names().into_iter().map(str::to_owned);
            let (mut names, mut joints) = (names.collect::<Vec<_>>(), arm.joints().to_vec());
            if let Some((name, apart)) = known.fingers.clone().zip(self.cell.fingers(index)) {
                names.push(name);
                joints.push(apart);
            }
            let message = json!({
                "header": { "stamp": stamp(known.version, now), "frame_id": "" },
                "name": names, "position": joints, "velocity": [], "effort": [],
            });
            let topic = known.joint_states.clone();
            let text = published(&topic, message);
            reports.push((topic, text));
        }
        for [motion, _] in &self.actions {
            if let Some(goal) = &motion.goal {
                send_to(&mut self.clients, goal.client, &goal.name.feedback());
            }
        }
        for client in &mut self.clients {
            for (topic, text) in &reports {
                client.publish(topic, text);
            }
            client.ping(now);
        }
    }

    /// Publishes the goals of each ROS 1 action, even if there are none, since clients wait for
    /// this list.
    fn report_goals(&mut self) {
        if self.last_status.elapsed() < STATUS {
            return;
        }
        self.last_status = Instant::now();
        let now = self.cell.time();
        for (arm, known) in self.topics.arms.iter().enumerate() {
            if known.version != RosVersion::One {
                continue;
            }
            let stamp = stamp(known.version, now);
            let names = std::iter::once(&known.action).chain(&known.gripper);
            for (name, action) in names.zip(&mut self.actions[arm]) {
                let under_way = action.goal.as_ref().map(|goal| goal.name.id.as_str());
                let topic = format!("{name}/status");
                let text = published(&topic, action.ended.listed(under_way, &stamp));
                for client in &mut self.clients {
                    client.publish(&topic, &text);
                }
            }
        }
    }

    /// Time of the cell's clock, s, that a picture in progress allows. A camera sends a picture
    /// before the next one is due; a clock faster than real time waits for it, so that the picture
    /// shows the present, and the simulation leaves the processor to it.
    fn end_of_picture(&self) -> f64 {
        let is_busy = self.pictures.as_ref().is_some_and(PictureTaker::is_busy);
        if is_busy && self.rate > 1.0 {
            self.last_picture + PICTURE
        } else {
            f64::INFINITY
        }
    }

    /// Takes pictures while the topic of the camera has subscribers.
    fn take_pictures(&mut self) {
        let Some(pictures) = &mut self.pictures else {
            return;
        };
        let topic = &self.topics.camera;
        if let Some(picture) = pictures.finished() {
            // Later subscribers receive the next picture: this one shows an earlier state.
            let watchers = std::mem::take(&mut self.watchers);
            let watching = self.clients.iter_mut();
            for client in watching.filter(|client| !client.is_full()) {
                if watchers.contains(&client.id) {
                    client.publish(topic, &picture);
                }
            }
        }
        let watching = self.clients.iter().filter(|client| client.awaits(topic));
        let watching: Vec<u64> = watching.map(|client| client.id).collect();
        let now = self.cell.time();
        if !watching.is_empty() && pictures.is_ready() && now - self.last_picture >= PICTURE {
            self.last_picture = now;
            self.watchers = watching;
            pictures.begin(self.cell.scenery(), topic, stamp(self.topics.version, now));
        }
    }
}

/// Sends a message to the client with an id, if it is still connected.
fn send_to(clients: &mut [Connection], id: u64, text: &str) {
    if let Some(client) = clients.iter_mut().find(|client| client.id == id) {
        client.send(text);
    }
}

impl From<Refusal> for Verdict {
    fn from(Refusal { code, words }: Refusal) -> Self {
        Self::Aborted(code, words)
    }
}
