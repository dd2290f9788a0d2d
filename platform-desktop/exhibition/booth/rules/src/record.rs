//! Records: structs that are stored as table rows. The columns are named like the fields.

use crate::value::Value;

/// The values of a row's columns.
pub type Row = Vec<Value>;

/// A struct that is stored as a row of a table in [`SCHEMA`](crate::records::SCHEMA).
pub trait Record: Sized {
    /// The name of the table.
    const TABLE: &'static str;
    /// The quoted column names in the order of the fields, as in SQL: `"id", "order"`.
    const COLUMNS: &'static str;
    /// The number of primary key columns, which come first.
    const KEY_COLUMNS: usize;

    /// Returns the values of the fields.
    fn to_row(&self) -> Row;

    /// Reads a row.
    ///
    /// # Errors
    /// The name of the first column whose value has the wrong type for its field.
    fn from_row(row: Row) -> Result<Self, &'static str>;
}

/// Defines a struct and its table. The first `key` fields are the primary key.
macro_rules! record {
    (
        $(#[$about:meta])*
        pub struct $Name:ident in $table:literal, key $key:literal {
            $($(#[$about_field:meta])* pub $field:ident: $Type:ty,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, PartialEq, Eq, Debug)]
        pub struct $Name { $($(#[$about_field])* pub $field: $Type,)* }

        impl $crate::record::Record for $Name {
            const TABLE: &'static str = $table;
            const COLUMNS: &'static str = {
                let columns = concat!($("\"", stringify!($field), "\", "),*);
                columns.split_at(columns.len() - ", ".len()).0
            };
            const KEY_COLUMNS: usize = $key;

            fn to_row(&self) -> $crate::record::Row {
                vec![$($crate::value::ToValue::to_value(&self.$field)),*]
            }

            fn from_row(row: $crate::record::Row) -> Result<Self, &'static str> {
                let mut values = row.into_iter();
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
