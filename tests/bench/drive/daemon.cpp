// Starting and ending iox-roudi.
#include "daemon.hpp"

#include <iostream>
#include <pwd.h>
#include <unistd.h>

namespace hive::bench {
namespace fs = std::filesystem;
namespace {

constexpr auto roudi = "/usr/bin/iox-roudi";

std::string user_name()
{
    const auto* user = ::getpwuid(::getuid());
    return user ? user->pw_name : "";
}

/// What iceoryx makes: its management segment, and the payload, called after the user.
bool of_iceoryx(const fs::path& file)
{
    return file.filename().string().starts_with("iceoryx") || file.filename() == user_name();
}

}  // namespace

Daemon::Daemon(const fs::path& programs) : log_("/tmp/hive-bench-roudi-" + std::to_string(::getpid()) + ".log")
{
    if (!fs::exists(roudi) || !fs::exists(programs / "bench_iceoryx"))
        return;
    process_.emplace(std::vector<std::string>{roudi, "-c", HIVE_BENCH_ROUDI, "-m", "off"}, std::vector<std::string>{},
                     log_);
    const bool ready = test::eventually([&] {
        return process_->wait(test::Milliseconds(0)) || test::text_of(log_).find("ready") != std::string::npos;
    });
    if (ready && !process_->wait(test::Milliseconds(0)))
        return;
    std::cerr << "without iceoryx: iox-roudi does not run:\n" << test::text_of(log_);
    process_.reset();
}

Daemon::~Daemon()
{
    std::error_code ignored;
    if (process_) {
        // Not by SIGTERM: it would pass that on to the ids of clients that ended badly, and the kernel may have given
        // those to others.
        process_->kill();
        for (const auto& entry : fs::directory_iterator("/dev/shm"))
            if (of_iceoryx(entry.path()))
                fs::remove(entry.path(), ignored);
    }
    fs::remove(log_, ignored);
}

}  // namespace hive::bench
