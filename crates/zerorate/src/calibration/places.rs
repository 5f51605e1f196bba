//! Where things stand in the text of a calibration: lines, and the axes that they belong to.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use zerorate_allan::toml_error::line_of;

/// A line, from 1, and the axis to which it belongs, if it belongs to one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) line: usize,
    pub(super) axis: Option<String>,
}

/// A text with its tables.
pub(super) struct Places<'t> {
    text: &'t str,
    root: DeTable<'t>,
}

impl<'t> Places<'t> {
    pub(super) fn new(text: &'t str) -> Result<Self, toml::de::Error> {
        Ok(Self { text, root: DeTable::parse(text)?.into_inner() })
    }

    /// Of a key below the root or below an axis; where it is missing, of what it is missing in.
    pub(super) fn of(&self, axis: Option<usize>, path: &[&str]) -> Place {
        let whole = axis.and_then(|index| self.axes().nth(index));
        let mut at = whole.as_ref().map_or(0, |(span, _)| span.start);
        let mut table = whole.map_or(Some(&self.root), |(_, table)| table);
        for key in path {
            let entry = table.and_then(|table| table.iter().find(|(name, _)| name.get_ref() == key));
            let Some((name, value)) = entry else { break };
            at = name.span().start;
            table = value.get_ref().as_table();
        }
        self.at(at)
    }

    /// Of a byte of the text.
    pub(super) fn at(&self, byte: usize) -> Place {
        Place { line: line_of(self.text, byte), axis: self.axis_at(byte) }
    }

    /// Calls `judge` with every value and its key, in the root and in all tables below.
    pub(super) fn each<E>(&self, mut judge: impl FnMut(&str, &DeValue<'_>, Place) -> Result<(), E>) -> Result<(), E> {
        let mut tables = alloc::vec![&self.root];
        while let Some(table) = tables.pop() {
            for (name, value) in table {
                judge(name.get_ref(), value.get_ref(), self.at(name.span().start))?;
                let elements = value.get_ref().as_array().into_iter().flatten().map(Spanned::get_ref);
                tables.extend(elements.chain([value.get_ref()]).filter_map(DeValue::as_table));
            }
        }
        Ok(())
    }

    /// Each `[[axis]]`: where it begins, and its table.
    fn axes(&self) -> impl Iterator<Item = (Range<usize>, Option<&DeTable<'t>>)> {
        let axes = self.root.iter().filter(|(name, _)| name.get_ref() == "axis");
        let each = axes.flat_map(|(_, value)| value.get_ref().as_array().into_iter().flatten());
        each.map(|axis| (axis.span(), axis.get_ref().as_table()))
    }

    /// The axis whose tables the byte stands in: the last that begins before it, if no other table begins in between.
    fn axis_at(&self, byte: usize) -> Option<String> {
        let mut begins: Vec<(usize, Option<usize>)> =
            self.axes().enumerate().map(|(index, (span, _))| (span.start, Some(index))).collect();
        let others = self.root.iter().filter(|(name, _)| name.get_ref() != "axis");
        begins.extend(others.map(|(name, value)| (name.span().start.min(value.span().start), None)));
        let (_, axis) = begins.into_iter().filter(|(start, _)| *start <= byte).max_by_key(|(start, _)| *start)?;
        Some(self.name(axis?))
    }

    /// What an axis is called; where it has no name, its number.
    fn name(&self, axis: usize) -> String {
        let table = self.axes().nth(axis).and_then(|(_, table)| table);
        let name = table.and_then(|table| table.iter().find(|(key, _)| key.get_ref() == "name"));
        let text = name.and_then(|(_, name)| name.get_ref().as_str());
        text.map_or_else(|| (axis + 1).to_string(), ToString::to_string)
    }
}
