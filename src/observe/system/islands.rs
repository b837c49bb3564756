//! Which bodies rows connect.

use super::*;

impl System {
    /// Bodies that impulses move are connected by rows; kinematic and static ones connect nothing.
    pub(super) fn find_islands(&mut self) {
        let mut parent: Vec<usize> = (0..self.bodies.len()).collect();
        fn root(parent: &mut [usize], mut i: usize) -> usize {
            while parent[i] != i {
                parent[i] = parent[parent[i]];
                i = parent[i];
            }
            i
        }
        let dynamic = |row: &SystemRow| row.bodies.map(|b| b.filter(|&b| self.bodies[b].dynamic));
        for row in &self.rows {
            let mut own = dynamic(row).into_iter().flatten();
            let Some(first) = own.next() else { continue };
            for other in own {
                let (a, b) = (root(&mut parent, first), root(&mut parent, other));
                // The lower index stays: islands are in the order of their first bodies.
                parent[a.max(b)] = a.min(b);
            }
        }
        let mut place = vec![usize::MAX; self.bodies.len()];
        let mut islands: Vec<SystemIsland> = Vec::new();
        let mut has_rows = vec![false; self.bodies.len()];
        for law in &self.laws {
            if let Some(body) = dynamic(&self.rows[law.first]).into_iter().flatten().next() {
                has_rows[root(&mut parent, body)] = true;
            }
        }
        for i in (0..self.bodies.len()).filter(|&i| self.bodies[i].dynamic) {
            let top = root(&mut parent, i);
            if !has_rows[top] {
                continue;
            }
            if place[top] == usize::MAX {
                place[top] = islands.len();
                islands.push(SystemIsland::default());
            }
            islands[place[top]].bodies.push(i);
        }
        for (i, law) in self.laws.iter().enumerate() {
            if let Some(body) = dynamic(&self.rows[law.first]).into_iter().flatten().next() {
                islands[place[root(&mut parent, body)]].laws.push(i);
            }
        }
        self.islands = islands;
    }
}
