//! Media, phase functions and volumes.

use super::Builder;
use crate::ids::MediumId;
use crate::medium::MEDIA;
use crate::medium::MediumInterface;
use crate::phase::PHASES;
use crate::phase::PhaseFunction;
use crate::plugin::find;
use crate::volume::VOLUMES;
use crate::volume::Volume;
use etendue_document::{Class, Fault, NodeId, Parameters};
use etendue_spectrum::SpectrumUse;

impl Builder<'_> {
    /// The volume of a `volume` node; `None` after an error has been reported.
    pub fn volume(&mut self, node: NodeId) -> Option<Volume> {
        if let Some(built) = self.volumes_built.get(&node) {
            return built.clone();
        }
        let parameters = self.parameters(node);
        let volume = find(VOLUMES, &parameters).and_then(|build| build(self, &parameters));
        if volume.is_some() {
            parameters.finish();
        }
        self.volumes_built.insert(node, volume.clone());
        volume
    }

    /// A parameter that is a volume, or a constant number or colour; `None` after an error has been
    /// reported.
    pub fn volume_or_color(
        &mut self,
        parameters: &Parameters<'_>,
        name: &str,
        default: f32,
        usage: SpectrumUse,
    ) -> Option<Volume> {
        let Some(child) = parameters.child(name) else {
            return Some(Volume::constant(self.constant_color(parameters, name, default, usage)));
        };
        if self.assets.document.node(child.node).class == Class::Volume {
            let volume = self.volume(child.node)?;
            if volume.channels() <= 3 {
                return Some(volume);
            }
            let message = "cells with six values are no colours: they belong to `sggx`";
            parameters.error(Fault::BadValue, name, message);
            return None;
        }
        parameters.error(Fault::BadValue, name, "expected a number, a colour or a volume");
        None
    }

    /// The phase function of a `phase` node; `None` after an error has been reported.
    pub fn phase(&mut self, node: NodeId) -> Option<PhaseFunction> {
        if let Some(built) = self.phases_built.get(&node) {
            return built.clone();
        }
        let parameters = self.parameters(node);
        let phase = find(PHASES, &parameters).and_then(|build| build(self, &parameters));
        if phase.is_some() {
            parameters.finish();
        }
        self.phases_built.insert(node, phase.clone());
        phase
    }

    /// The medium of a `medium` node; `None` after an error has been reported.
    pub fn medium(&mut self, node: NodeId) -> Option<MediumId> {
        if let Some(built) = self.media_built.get(&node) {
            return *built;
        }
        let parameters = self.parameters(node);
        let medium = find(MEDIA, &parameters).and_then(|build| build(self, &parameters));
        let id = medium.map(|medium| {
            self.media.push(medium);
            MediumId(self.media.len() as u32 - 1)
        });
        if id.is_some() {
            parameters.finish();
        }
        self.media_built.insert(node, id);
        id
    }

    /// The media on both sides of a shape.
    pub(super) fn medium_interface(
        &mut self,
        parameters: &Parameters<'_>,
    ) -> Option<MediumInterface> {
        let children = parameters.children_of(Class::Medium);
        let mut medium_interface = MediumInterface::default();
        for child in &children {
            let side = match child.name.as_deref() {
                Some("interior") => &mut medium_interface.interior,
                Some("exterior") => &mut medium_interface.exterior,
                _ => {
                    let message = "a shape's medium is its `interior` or its `exterior`: give it one of these names";
                    self.assets.diagnostics.warning(Fault::UnknownParameter, child.span, message);
                    continue;
                }
            };
            *side = self.medium(child.node);
        }
        (!children.is_empty()).then_some(medium_interface)
    }

    /// The medium around a sensor.
    pub(super) fn medium_around(&mut self, sensor: &Parameters<'_>) -> Option<MediumId> {
        let child = sensor.unnamed_child(Class::Medium)?;
        self.medium(child.node)
    }
}
