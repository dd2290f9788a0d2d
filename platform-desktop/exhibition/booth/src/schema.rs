//! The tables of a database, made of the records themselves.

use paros_booth_rules::records::TABLES;
use paros_booth_rules::{Column, ColumnKind, Table};

use crate::sqlite_store::{columns, name, quote};

/// The version of the tables. A change of a record raises it.
pub(crate) const VERSION: i64 = 1;

/// How a database writes the kinds of columns, and what ends a table's definition.
pub(crate) struct Dialect {
    pub(crate) number: &'static str,
    pub(crate) bytes: &'static str,
    pub(crate) text: &'static str,
    pub(crate) table_end: &'static str,
}

/// Why a database of another version isn't opened.
pub(crate) fn refuse_version(version: i64) -> String {
    format!(
        "its tables have version {version}, and this program reads version {VERSION}; \
         start it on a new folder or database, or run the program that made this one"
    )
}

/// The statements that make all tables and their indexes.
pub(crate) fn write_script(dialect: &Dialect) -> String {
    TABLES.iter().map(|table| write_table(table, dialect)).collect()
}

/// The statement that keeps a row, instead of that with its key. Its values have places with this letter: `$1`, `?1`.
pub(crate) fn write_put(table: &Table, letter: char) -> String {
    let places: Vec<String> = (1..=table.columns.len()).map(|k| format!("{letter}{k}")).collect();
    let (key, others) = table.columns.split_at(table.key_columns);
    let key: Vec<String> = key.iter().map(|column| quote(column.name)).collect();
    let set = |column: &Column| {
        let column = quote(column.name);
        format!("{column} = EXCLUDED.{column}")
    };
    let set: Vec<String> = others.iter().map(set).collect();
    let instead = if set.is_empty() {
        "NOTHING".to_owned()
    } else {
        format!("UPDATE SET {}", set.join(", "))
    };
    format!(
        "INSERT INTO {} ({}) VALUES ({}) ON CONFLICT ({}) DO {instead}",
        name(table),
        columns(table),
        places.join(", "),
        key.join(", ")
    )
}

fn write_table(table: &Table, dialect: &Dialect) -> String {
    let columns: Vec<String> =
        table.columns.iter().map(|column| write_column(column, dialect)).collect();
    let key: Vec<String> =
        table.columns[..table.key_columns].iter().map(|column| quote(column.name)).collect();
    let (columns, key, name) = (columns.join(", "), key.join(", "), name(table));
    let mut script =
        format!("CREATE TABLE {name} ({columns}, PRIMARY KEY ({key})){};", dialect.table_end);
    for column in table.indexed {
        let index = quote(&format!("{}_{column}", table.name));
        script += &format!("CREATE INDEX {index} ON {name} ({});", quote(column));
    }
    for column in table.unique {
        let index = quote(&format!("{}_{column}", table.name));
        script += &format!("CREATE UNIQUE INDEX {index} ON {name} ({});", quote(column));
    }
    script
}

fn write_column(column: &Column, dialect: &Dialect) -> String {
    let kind = match column.kind {
        ColumnKind::Number => dialect.number,
        ColumnKind::Bytes => dialect.bytes,
        ColumnKind::Text => dialect.text,
    };
    let rest = if column.is_nullable { "" } else { " NOT NULL" };
    format!("{} {kind}{rest}", quote(column.name))
}
