//! Lists that usually hold a single item.

use std::ops::{Deref, DerefMut};

/// A list that stores a single item inline, without an allocation.
///
/// Most nodes of a large document are instances with one parameter and one child. A vector's
/// header, allocation and spare capacity would take as much memory as the item.
#[derive(Clone)]
pub struct List<T>(Items<T>);

#[derive(Clone)]
enum Items<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> List<T> {
    /// An empty list.
    pub const fn new() -> Self {
        Self(Items::Many(Vec::new()))
    }

    /// Adds an item at the end.
    pub fn push(&mut self, item: T) {
        match &mut self.0 {
            Items::Many(items) if items.capacity() > 0 => items.push(item),
            Items::Many(_) => self.0 = Items::One(item),
            Items::One(_) => {
                let mut items = Vec::with_capacity(2);
                items.extend(std::mem::take(self));
                items.push(item);
                self.0 = Items::Many(items);
            }
        }
    }

    /// Keeps the items that `wanted` accepts, in order.
    pub fn retain(&mut self, mut wanted: impl FnMut(&T) -> bool) {
        match &mut self.0 {
            Items::Many(items) => items.retain(wanted),
            Items::One(item) => {
                if !wanted(item) {
                    self.clear();
                }
            }
        }
    }

    /// Removes everything.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// The items as a vector.
    pub fn into_vec(self) -> Vec<T> {
        match self.0 {
            Items::One(item) => vec![item],
            Items::Many(items) => items,
        }
    }
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.0 {
            Items::One(item) => std::slice::from_ref(item),
            Items::Many(items) => items,
        }
    }
}

impl<T> DerefMut for List<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.0 {
            Items::One(item) => std::slice::from_mut(item),
            Items::Many(items) => items,
        }
    }
}

impl<T> From<Vec<T>> for List<T> {
    fn from(mut items: Vec<T>) -> Self {
        match items.len() {
            1 => Self(items.pop().map_or_else(|| Items::Many(Vec::new()), Items::One)),
            _ => Self(Items::Many(items)),
        }
    }
}

impl<T> FromIterator<T> for List<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        items.into_iter().collect::<Vec<T>>().into()
    }
}

impl<T> Extend<T> for List<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().for_each(|item| self.push(item));
    }
}

impl<T> IntoIterator for List<T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.into_vec().into_iter()
    }
}

impl<'a, T> IntoIterator for &'a List<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut List<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl<T: PartialEq> PartialEq for List<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for List<T> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Debug::fmt(&**self, formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However items are added, the list holds them in order.
    #[test]
    fn it_is_a_vector_of_none_one_or_many() {
        let mut list = List::new();
        let mut vector: Vec<i32> = Vec::new();
        for item in 0..5 {
            assert_eq!(*list, *vector);
            assert_eq!(list, List::from(vector.clone()));
            list.push(item);
            vector.push(item);
        }
        for kept in [4, 1, 0] {
            list.retain(|item| *item < kept);
            vector.retain(|item| *item < kept);
            assert_eq!(*list, *vector);
        }
        let mut one: List<i32> = std::iter::once(7).collect();
        one.iter_mut().for_each(|item| *item += 1);
        one.extend([9]);
        assert_eq!(one.clone().into_iter().collect::<Vec<_>>(), [8, 9]);
        one = List::from(vec![3]);
        one.retain(|_| false);
        assert!(one.is_empty());
    }
}
