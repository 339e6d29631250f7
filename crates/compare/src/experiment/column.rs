//! Further columns of an experiment's table: numbers of the records by their paths.

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::ExperimentError;
use crate::record::path_problem;

/// A column that shows a number of every row's record.
///
/// In a file it is a path, or a table of `path`, `title` and `as`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Where the number stands in the record, such as `error.max`.
    pub path: String,
    /// What stands above the column; the path where a file gives no other.
    pub title: String,
    /// How the number is written.
    #[serde(rename = "as")]
    pub notation: Notation,
}

/// How a number is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Notation {
    /// In its usual form, with a power of ten where it is very large or small.
    #[default]
    Number,
    /// A fraction in percent.
    Percent,
    /// With a power of ten.
    Scientific,
    /// A time.
    Seconds,
}

/// A column as a table of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    path: String,
    title: Option<String>,
    #[serde(default, rename = "as")]
    notation: Notation,
}

impl Column {
    fn of(fields: Fields) -> Self {
        Self {
            title: fields.title.unwrap_or_else(|| fields.path.clone()),
            path: fields.path,
            notation: fields.notation,
        }
    }
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(PathOrFields)
    }
}

/// Reads both forms of a column, so that a mistake in either is told as what it is.
struct PathOrFields;

impl<'de> Visitor<'de> for PathOrFields {
    type Value = Column;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a path such as \"error.max\", or a table of `path`, `title` and `as`")
    }

    fn visit_str<E>(self, path: &str) -> Result<Column, E> {
        Ok(Column::of(Fields {
            path: path.to_owned(),
            title: None,
            notation: Notation::default(),
        }))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Column, A::Error> {
        Fields::deserialize(MapAccessDeserializer::new(map)).map(Column::of)
    }
}

/// Checks that records can have what the columns show.
pub(super) fn check(columns: &[Column], file: &str) -> Result<(), ExperimentError> {
    let refused = columns
        .iter()
        .find_map(|column| Some((column, path_problem(&column.path)?)));
    match refused {
        Some((column, problem)) => Err(ExperimentError::Column {
            path: file.to_owned(),
            column: column.path.clone(),
            problem,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::parse_with;
    use super::{Column, Notation};

    #[test]
    fn a_column_is_a_path_or_a_table() {
        let text = "columns = [\"error.max\", { path = \"checks.share\", title = \"share\", as = \"percent\" }, { path = \"dofs\" }]";
        let columns = parse_with(text, "").expect("good columns").columns;
        let of = |path: &str, title: &str, notation| Column {
            path: path.to_owned(),
            title: title.to_owned(),
            notation,
        };
        let expected = [
            of("error.max", "error.max", Notation::Number),
            of("checks.share", "share", Notation::Percent),
            of("dofs", "dofs", Notation::Number),
        ];
        assert_eq!(columns, expected);
        let json = serde_json::to_string(&columns).expect("JSON");
        let read: Vec<Column> = serde_json::from_str(&json).expect("read again");
        assert_eq!(read, expected);
    }

    #[test]
    fn mistakes_in_columns_are_told_with_the_file() {
        let bad = [
            ("[\"errors.max\"]", "column `errors.max`: no record has"),
            ("[{ title = \"t\" }]", "missing field `path`"),
            (
                "[{ path = \"dofs\", name = \"t\" }]",
                "unknown field `name`",
            ),
            (
                "[{ path = \"dofs\", as = \"metres\" }]",
                "unknown variant `metres`",
            ),
            ("[3]", "a path such as"),
        ];
        for (columns, message) in bad {
            let error = parse_with(&format!("columns = {columns}"), "").expect_err(columns);
            let text = error.to_string();
            assert!(
                text.contains(message) && text.contains("p/i.toml"),
                "{text}"
            );
        }
    }
}
