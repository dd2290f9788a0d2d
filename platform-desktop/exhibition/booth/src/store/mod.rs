//! The databases and the files in which the booth keeps sculptures.

pub(crate) mod deletion_log;
pub(crate) mod disk_files;
pub(crate) mod files;
pub(crate) mod folder_lock;
pub(crate) mod own_file;
pub(crate) mod postgres_link;
pub(crate) mod postgres_schema;
pub(crate) mod postgres_store;
pub(crate) mod s3_files;
