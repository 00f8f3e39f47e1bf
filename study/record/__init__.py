"""What is kept: a table of trials that no kill can harm, its sidecar, the BIDS data set around."""
