//! Goals of an action as its status topic lists them: the active goal, and recently ended goals.

use super::message::Verdict;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time for which an ended goal is listed, as in servers of `actionlib`.
const LISTED: Duration = Duration::from_secs(5);
/// Largest number of ended goals in the list.
const MOST: usize = 20;
/// `actionlib_msgs/GoalStatus` of an active goal.
const ACTIVE: u8 = 1;

/// Recently ended goals of an action.
#[derive(Default)]
pub struct GoalLog {
    ended: VecDeque<(String, u8, Instant)>,
}

impl GoalLog {
    /// Records how a goal ended.
    pub fn note(&mut self, id: &str, verdict: &Verdict) {
        if self.ended.len() >= MOST {
            self.ended.pop_front();
        }
        let status = verdict.status_of_ros_1();
        self.ended
            .push_back((id.to_owned(), status, Instant::now()));
    }

    /// Returns an `actionlib_msgs/GoalStatusArray` with a stamp: recently ended goals, and the
    /// active one.
    pub fn listed(&mut self, under_way: Option<&str>, stamp: &Value) -> Value {
        self.ended.retain(|(.., at)| at.elapsed() < LISTED);
        let status = |id: &str, status: u8| json!({ "goal_id": { "stamp": stamp, "id": id }, "status": status, "text": "" });
        let ended = self.ended.iter().map(|(id, code, _)| status(id, *code));
        let active = under_way.iter().map(|id| status(id, ACTIVE));
        let list: Vec<Value> = ended.chain(active).collect();
        json!({ "header": { "seq": 0, "stamp": stamp, "frame_id": "" }, "status_list": list })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_listed_under_way_and_after_their_end_up_to_a_bound() {
        let mut log = GoalLog::default();
        let stamp = json!({ "secs": 1, "nsecs": 0 });
        assert_eq!(log.listed(None, &stamp)["status_list"], json!([]));
        for k in 0..1000 {
            log.note(&format!("goal {k}"), &Verdict::Succeeded);
        }
        log.note("last", &Verdict::Cancelled);
        let list = log.listed(Some("now"), &stamp)["status_list"].take();
        let list = list.as_array().unwrap();
        assert_eq!(list.len(), MOST + 1);
        for (goal, id, status) in [(&list[MOST - 1], "last", 2), (&list[MOST], "now", 1)] {
            assert_eq!(goal["goal_id"]["id"], id);
            assert_eq!(goal["status"], status);
        }
    }
}
