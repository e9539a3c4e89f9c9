//! Makes a plan that fails as small as it gets and still fails.

use super::plan::Plan;
use super::play::{Fault, play};

/// Most plays of one plan.
const TRIES: u32 = 400;

/// The smallest plan found that fails as `plan` does: fewer acts first, then fewer ticks, then fewer cells.
pub fn shrink(plan: &Plan) -> Plan {
    shrink_by(plan, &|plan| play(plan).fault)
}

/// The same where `judge` tells of the first fault and its tick.
fn shrink_by(plan: &Plan, judge: &dyn Fn(&Plan) -> Option<(Fault, u32)>) -> Plan {
    let Some((fault, tick)) = judge(plan) else { return plan.clone() };
    let mut search = Search { judge, fault, best: Plan { ticks: tick + 1, ..plan.clone() }, left: TRIES };
    search.best.acts.retain(|due| due.tick <= tick);
    loop {
        let before = search.best.clone();
        search.fewer_acts();
        search.fewer_cells();
        if search.best == before || search.left == 0 {
            return search.best;
        }
    }
}

struct Search<'a> {
    judge: &'a dyn Fn(&Plan) -> Option<(Fault, u32)>,
    fault: Fault,
    best: Plan,
    left: u32,
}

impl Search<'_> {
    /// Keeps `plan` if it still fails.
    fn offer(&mut self, mut plan: Plan) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        let Some((_, tick)) = (self.judge)(&plan).filter(|(fault, _)| *fault == self.fault) else { return false };
        plan.ticks = tick + 1;
        plan.acts.retain(|due| due.tick <= tick);
        self.best = plan;
        true
    }

    /// Leaves out runs of acts, long ones first (delta debugging, Zeller & Hildebrandt 2002).
    fn fewer_acts(&mut self) {
        let mut run = self.best.acts.len().div_ceil(2);
        while run > 0 {
            let mut from = 0;
            while from < self.best.acts.len() {
                let mut plan = self.best.clone();
                plan.acts.drain(from..(from + run).min(plan.acts.len()));
                if !self.offer(plan) {
                    from += run;
                }
            }
            run = if run == 1 { 0 } else { run.div_ceil(2) };
        }
    }

    /// Halves, then thins out by one, rows and columns of the same cells.
    fn fewer_cells(&mut self) {
        for axis in 0..2 {
            for by_half in [true, false] {
                loop {
                    let mut plan = self.best.clone();
                    let before = plan.cells[axis];
                    plan.cells[axis] = if by_half { before / 2 } else { before - 1 };
                    if plan.cells[axis] == 0 {
                        break;
                    }
                    plan.size[axis] *= plan.cells[axis] as f32 / before as f32;
                    if !self.offer(plan) {
                        break;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec3};

    use super::*;
    use crate::stability::monkey::{Act, Tool};

    #[test]
    fn what_takes_a_tear_in_a_wind_and_three_columns_is_shrunk_to_just_that() {
        let judge = |plan: &Plan| {
            let wind = plan.acts.iter().position(|due| matches!(due.act, Act::Wind(v) if v != Vec3::ZERO))?;
            let torn = plan.acts[wind..].iter().find(|due| matches!(due.act, Act::Tear { .. }))?;
            (plan.cells.x >= 3 && plan.ticks > torn.tick).then_some((Fault::TooFast, torn.tick))
        };
        let plans = (0..).map(|seed| Plan::new(seed, 600, &Tool::ALL));
        let plan = plans.filter(|plan| plan.cells.min_element() > 5).find(|plan| judge(plan).is_some()).unwrap();
        let small = shrink_by(&plan, &judge);
        assert_eq!(small.acts.len(), 2, "{small:?}");
        assert_eq!(small.cells, UVec2::new(3, 1));
        assert_eq!(small.ticks, small.acts[1].tick + 1);
        assert!((small.size.x / 3.0 - plan.size.x / plan.cells.x as f32).abs() < 1e-6, "cells keep their size");
    }

    #[test]
    fn a_plan_that_holds_stays_as_it_is() {
        let plan = Plan::new(1, 600, &Tool::ALL);
        assert_eq!(shrink_by(&plan, &|_| None), plan);
    }
}
