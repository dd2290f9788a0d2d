//! Queries in the words of PostgreSQL. A value is never in them, but has a place `$1`.

use paros_booth_rules::{
    Column, ColumnKind, Condition, Query, Row, RowOrder, StoreError, Table, Value,
};

use crate::postgres_store::store_error;
use crate::sqlite_store::{check_column, quote};

/// Whether it is a text that no row has, and which PostgreSQL wouldn't take as a question either.
pub(crate) fn has_nul(value: &Value) -> bool {
    matches!(value, Value::Text(text) if text.contains('\0'))
}

/// The condition of a key, whose values are the first ones.
pub(crate) fn key_is(table: &Table) -> String {
    let key = table.columns[..table.key_columns].iter().enumerate();
    let equal: Vec<String> =
        key.map(|(k, column)| format!("{} = ${}", quote(column.name), k + 1)).collect();
    equal.join(" AND ")
}

/// Conditions, and the values of their places; `None` where no row can fulfil them.
pub(crate) fn write_conditions(query: &Query) -> Result<Option<(String, Vec<&Value>)>, StoreError> {
    let (mut terms, mut values) = (vec!["true".to_owned()], Vec::new());
    let mut can_be = true;
    for condition in &query.conditions {
        let (column, sign, value) = match condition {
            Condition::Equal(column, Value::Null) => (column, "IS NULL", None),
            Condition::Equal(column, value) => (column, "=", Some(value)),
            Condition::Below(column, value) => (column, "<", Some(value)),
            Condition::AtLeast(column, value) => (column, ">=", Some(value)),
            Condition::Present(column) => (column, "IS NOT NULL", None),
        };
        check_column(query.table, column)?;
        let column = quote(column);
        match value {
            Some(value) => {
                can_be &= !has_nul(value);
                values.push(value);
                terms.push(format!("{column} {sign} ${}", values.len()));
            }
            None => terms.push(format!("{column} {sign}")),
        }
    }
    Ok(can_be.then(|| (terms.join(" AND "), values)))
}

/// By what a query orders.
pub(crate) fn write_order(query: &Query) -> Result<String, StoreError> {
    let table = query.table;
    let mut order = Vec::new();
    if let Some((column, direction)) = query.order {
        check_column(table, column)?;
        let is_nullable =
            table.columns.iter().any(|known| known.name == column && known.is_nullable);
        // Nothing is less than all others. An index has it elsewhere, but serves where there is always something.
        let direction = match (direction, is_nullable) {
            (RowOrder::Ascending, false) => "ASC",
            (RowOrder::Ascending, true) => "ASC NULLS FIRST",
            (RowOrder::Descending, false) => "DESC",
            (RowOrder::Descending, true) => "DESC NULLS LAST",
        };
        order.push(format!("{} {direction}", quote(column)));
    }
    order.extend(table.columns[..table.key_columns].iter().map(|column| quote(column.name)));
    Ok(order.join(", "))
}

/// A row of a table, whose columns were asked for in their order.
pub(crate) fn read_row(table: &Table, row: &postgres::Row) -> Result<Row, StoreError> {
    let read = |(k, column): (usize, &Column)| {
        let value = match column.kind {
            ColumnKind::Number => row.try_get::<_, Option<i64>>(k)?.map(Value::Number),
            ColumnKind::Bytes => row.try_get::<_, Option<Vec<u8>>>(k)?.map(Value::Bytes),
            ColumnKind::Text => row.try_get::<_, Option<String>>(k)?.map(Value::Text),
        };
        Ok(value.unwrap_or(Value::Null))
    };
    table.columns.iter().enumerate().map(read).collect::<Result<_, _>>().map_err(store_error)
}
