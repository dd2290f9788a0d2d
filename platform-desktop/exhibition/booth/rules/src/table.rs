//! Tables, and records as rows of them.

use crate::value::{ColumnKind, Value};

/// A row: a value for each column of its table.
pub type Row = Vec<Value>;

/// A table, as a store has to make it.
#[derive(Debug)]
pub struct Table {
    /// A word of small letters and `_`.
    pub name: &'static str,
    /// The first ones are the key.
    pub columns: &'static [Column],
    /// Columns of the key; no two rows have the same one.
    pub key_columns: usize,
    /// Columns by which rows are looked for.
    pub indexed: &'static [&'static str],
    /// Columns in which no two rows have the same value, but nothing.
    pub unique: &'static [&'static str],
}

/// A column of a table.
#[derive(Debug)]
pub struct Column {
    /// A word of small letters and `_`.
    pub name: &'static str,
    /// What it holds.
    pub kind: ColumnKind,
    /// Whether it may hold nothing.
    pub is_nullable: bool,
}

/// A struct that is kept as a row.
pub trait Record: Sized {
    /// Where it is kept.
    const TABLE: &'static Table;

    /// Its fields, in the order of the columns.
    fn to_row(&self) -> Row;

    /// What [`Record::to_row`] made this row of.
    ///
    /// # Errors
    /// The name of the column whose value is none of the field's type.
    fn from_row(row: &[Value]) -> Result<Self, &'static str>;
}

impl Table {
    /// The place of a column; `None` where there is none of this name.
    #[must_use]
    pub fn find_column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// Whether a row has the right number of values, each of its column's kind, and no text with a NUL in it.
    #[must_use]
    pub fn fits(&self, row: &[Value]) -> bool {
        row.len() == self.columns.len()
            && row.iter().zip(self.columns).all(|(value, column)| column.fits(value))
    }
}

impl Column {
    fn fits(&self, value: &Value) -> bool {
        match (value, self.kind) {
            (Value::Null, _) => self.is_nullable,
            (Value::Number(_), ColumnKind::Number) | (Value::Bytes(_), ColumnKind::Bytes) => true,
            // No text of PostgreSQL's has it, and none of a person's.
            (Value::Text(text), ColumnKind::Text) => !text.contains('\0'),
            _ => false,
        }
    }
}

/// A struct and its table, whose columns have the fields' names: the first `key` of them are the key.
macro_rules! record {
    (
        $(#[$about:meta])*
        pub struct $Name:ident in $table:literal, key $key:literal, indexed [$($indexed:literal),*]
            $(, unique [$($unique:literal),*])? {
            $($(#[$about_field:meta])* pub $field:ident: $Type:ty,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, PartialEq, Eq, Debug)]
        pub struct $Name { $($(#[$about_field])* pub $field: $Type,)* }

        impl $crate::table::Record for $Name {
            const TABLE: &'static $crate::table::Table = &$crate::table::Table {
                name: $table,
                columns: &[$($crate::table::Column {
                    name: stringify!($field),
                    kind: <$Type as $crate::value::Field>::KIND,
                    is_nullable: <$Type as $crate::value::Field>::IS_NULLABLE,
                }),*],
                key_columns: $key,
                indexed: &[$($indexed),*],
                unique: &[$($($unique),*)?],
            };

            fn to_row(&self) -> $crate::table::Row {
                vec![$($crate::value::Field::to_value(&self.$field)),*]
            }

            fn from_row(row: &[$crate::value::Value]) -> Result<Self, &'static str> {
                let mut values = row.iter();
                Ok($Name {$(
                    $field: values
                        .next()
                        .and_then($crate::value::Field::from_value)
                        .ok_or(stringify!($field))?,
                )*})
            }
        }
    };
}

pub(crate) use record;
