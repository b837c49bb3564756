//! Values by entity, side by side in memory.

use bevy_ecs::entity::Entity;

/// Marks an entity without a value.
const NONE: u32 = u32::MAX;

/// A map from entities to values that finds one by two loads, without a hash, and lists them in the order in
/// which they came, as far as none was removed. It needs 4 bytes for each index of an entity that the app has
/// had.
#[derive(Debug)]
pub(crate) struct EntityTable<T> {
    /// Where the value of an entity is, by the entity's index.
    places: Vec<u32>,
    entities: Vec<Entity>,
    values: Vec<T>,
}

impl<T> Default for EntityTable<T> {
    fn default() -> Self {
        EntityTable { places: Vec::new(), entities: Vec::new(), values: Vec::new() }
    }
}

impl<T> EntityTable<T> {
    #[inline]
    fn place(&self, entity: &Entity) -> Option<usize> {
        let place = *self.places.get(entity.index_u32() as usize)? as usize;
        (self.entities.get(place) == Some(entity)).then_some(place)
    }
    #[inline]
    pub(crate) fn get(&self, entity: &Entity) -> Option<&T> {
        self.place(entity).map(|place| &self.values[place])
    }
    #[inline]
    pub(crate) fn get_mut(&mut self, entity: &Entity) -> Option<&mut T> {
        self.place(entity).map(|place| &mut self.values[place])
    }
    pub(crate) fn contains_key(&self, entity: &Entity) -> bool {
        self.place(entity).is_some()
    }
    pub(crate) fn insert(&mut self, entity: Entity, value: T) {
        self.remove(&entity);
        let index = entity.index_u32() as usize;
        if self.places.len() <= index {
            self.places.resize(index + 1, NONE);
        }
        self.places[index] = self.values.len() as u32;
        self.entities.push(entity);
        self.values.push(value);
    }
    pub(crate) fn remove(&mut self, entity: &Entity) -> Option<T> {
        let place = self.place(entity)?;
        self.places[entity.index_u32() as usize] = NONE;
        self.entities.swap_remove(place);
        if let Some(moved) = self.entities.get(place) {
            self.places[moved.index_u32() as usize] = place as u32;
        }
        Some(self.values.swap_remove(place))
    }
    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }
    /// The entity of a place in the order of the values.
    pub(crate) fn key(&self, place: usize) -> Option<Entity> {
        self.entities.get(place).copied()
    }
    pub(crate) fn keys(&self) -> impl Iterator<Item = &Entity> {
        self.entities.iter()
    }
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&Entity, &T)> {
        self.entities.iter().zip(&self.values)
    }
    pub(crate) fn values_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.values.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_ecs::world::World;
    use std::collections::HashMap;

    /// Entities that come and go in turn, some with indices that were used before. Expected: what a map of
    /// the standard library has.
    #[test]
    fn a_table_is_a_map() {
        let (mut world, mut table, mut map) = (World::new(), EntityTable::default(), HashMap::new());
        let mut alive: Vec<Entity> = Vec::new();
        for round in 0..500_usize {
            if round % 3 == 2 {
                let entity = alive.remove((round * 7) % alive.len());
                assert_eq!(table.remove(&entity), map.remove(&entity));
                assert!(table.get(&entity).is_none() && table.remove(&entity).is_none());
                world.despawn(entity);
            } else {
                let entity = world.spawn_empty().id();
                alive.push(entity);
                table.insert(entity, round);
                table.insert(entity, round + 1);
                map.insert(entity, round + 1);
            }
            assert_eq!(table.len(), map.len());
            assert!(map.iter().all(|(entity, value)| table.get(entity) == Some(value)));
        }
        assert_eq!(table.keys().count(), map.len());
        table.values_mut().for_each(|value| *value = 0);
        assert!(table.keys().all(|entity| table.get(entity) == Some(&0)));
    }
}
