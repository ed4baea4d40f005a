"""What each rule of the workflow runs: read inputs, call the library, write outputs."""
