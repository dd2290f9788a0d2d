//! Folders and buckets keep the files of a booth.

#[path = "../common/s3_server.rs"]
mod s3_server;

mod files;
