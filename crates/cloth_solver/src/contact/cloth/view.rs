//! The pairs that contact among cloth follows, as points and lines: for debug views.

use glam::{Vec3, Vec3A};

use super::group::GroupContacts;
use super::nearest::nearest;
use super::state::State;
use super::{SelfContacts, four};
use crate::Pose;
use crate::contact::ContactPoint;

impl SelfContacts {
    /// The nearest points of every pair of features that may come near each other, where the last substep ended, m. Of a cloth that steps
    /// alone; of one in a group see [`GroupContacts::candidate_lines`].
    pub fn candidate_lines(&self) -> Vec<[Vec3; 2]> {
        self.state.candidate_lines(|_| true)
    }

    /// Every point at which the cloth pressed on itself in the last substep. Of a cloth that steps alone.
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        self.state.contact_points(|_| true)
    }
}

impl GroupContacts {
    /// As [`SelfContacts::candidate_lines`], of the pairs of cloth number `index` with itself and others, in its own frame. None if there
    /// is no such cloth.
    pub fn candidate_lines(&self, index: usize) -> Vec<[Vec3; 2]> {
        let Some((frame, is_of)) = self.member(index) else { return Vec::new() };
        let lines = self.state.candidate_lines(is_of);
        lines.into_iter().map(|line| line.map(|point| frame.inverse_point(point))).collect()
    }

    /// As [`SelfContacts::contact_points`], of cloth number `index` on itself and others, in its own frame.
    pub fn contact_points(&self, index: usize) -> Vec<ContactPoint> {
        let Some((frame, is_of)) = self.member(index) else { return Vec::new() };
        let own = |ContactPoint { point, normal }| ContactPoint {
            point: frame.inverse_point(point),
            normal: frame.rotation.conjugate() * normal,
        };
        self.state.contact_points(is_of).into_iter().map(own).collect()
    }

    /// The frame of a cloth, and whether a pair is one of its pairs.
    fn member(&self, index: usize) -> Option<(Pose, impl Fn(&[u32; 4]) -> bool + use<'_>)> {
        let (slots, frame) = self.slots_and_frame(index)?;
        Some((frame, move |ids: &[u32; 4]| ids.iter().any(|id| slots.contains(id))))
    }
}

impl State {
    fn candidate_lines(&self, is_shown: impl Fn(&[u32; 4]) -> bool) -> Vec<[Vec3; 2]> {
        let shown = self.pairs.iter().filter(|pair| is_shown(&pair.ids));
        let line = |pair: &super::candidates::Pair| {
            let points = four(self.response.ends(), &pair.ids);
            let found = nearest(pair.kind, &points);
            let first = on_first(&points, &found.weights);
            [first.into(), (first - found.between).into()]
        };
        shown.map(line).collect()
    }

    fn contact_points(&self, is_shown: impl Fn(&[u32; 4]) -> bool) -> Vec<ContactPoint> {
        let shown = self.response.pressing_contacts().filter(|(ids, ..)| is_shown(ids));
        let point = |(ids, weights, normal): (&[u32; 4], &[f32; 4], Vec3A)| {
            let points = four(self.response.ends(), ids);
            let (first, second) = (on_first(&points, weights), -on_first(&points, &weights.map(|weight| -weight)));
            ContactPoint { point: (0.5 * (first - second)).into(), normal: normal.into() }
        };
        shown.map(point).collect()
    }
}

/// The point of the first feature: of the weights those above zero.
fn on_first(points: &[Vec3A; 4], weights: &[f32; 4]) -> Vec3A {
    (0..4).map(|i| points[i] * weights[i].max(0.0)).sum()
}
