//! Recognises that a launcher started several copies of the program at once: `mpirun` or the like.

use proofmass_base::error::{Error, Result};

/// Environment variables in which launchers write how many there are: Open MPI, and those that
/// speak PMI (MPICH, Slurm).
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// Returns the number of ranks that a launcher has started, where it is more than one.
pub(super) fn ranks() -> Option<u64> {
    let size = |name: &&str| std::env::var(name).ok()?.trim().parse().ok();
    SIZES.iter().find_map(size).filter(|ranks| *ranks > 1)
}

/// Refuses to do the same work once for each rank.
///
/// # Errors
/// There is more than one.
pub(super) fn refuse_ranks(command: &str) -> Result<()> {
    let Some(ranks) = ranks() else { return Ok(()) };
    let built = match cfg!(feature = "mpi") {
        true => format!("ranks share the work of `study` only, not of `{command}`"),
        false => "this proofmass was built without MPI: each rank would do all of the work".to_owned(),
    };
    Err(Error::new(
        format!("could not run `{command}` on {ranks} ranks"),
        built,
        "start it once; or divide it with --shard K/N and merge; or build with `cargo build --release --features mpi`, \
         which takes an MPI library and libclang, and run `mpirun -n 4 proofmass study`",
    ))
}
