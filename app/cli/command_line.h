// The command line as a whole: words in, exit code out.
#pragma once

namespace tiltmap::cli {

// Runs one command. Exit code 0 done (warnings allowed), 1 failed, 2 wrong usage.
int run(int argc, char** argv);

}  // namespace tiltmap::cli
