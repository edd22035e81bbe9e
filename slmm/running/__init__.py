"""What every part of the package needs to live on a machine: files, threads, processes, progress, text."""
