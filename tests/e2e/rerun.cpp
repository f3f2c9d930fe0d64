// A kept failure is rerun: with another build, from a file, from another machine; and Ctrl-C at any moment.
#include "fake_ssh.hpp"
#include "own_temp.hpp"

#include <csignal>
#include <fstream>
#include <sys/stat.h>

namespace {

using namespace hive;
using namespace std::chrono_literals;
using hive::test::eventually;
using hive::test::failures;
using hive::test::FakeSsh;
using hive::test::has;
using hive::test::OwnTemp;
using hive::test::Swarm;

void put_one(Application& application, const std::string& drone, std::size_t bytes = 1)
{
    application.put({drone, "image"}, Json::object(), Body(std::string(bytes, 'x')), "text/plain");
    failures(application, drone);
}

std::string content(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("rerun: another build, words before the drone, a kind that is said, and nothing that is kept")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto victim = swarm.drone("breaker", "victim", {"how=throw", "from=1"});
    put_one(application, "victim");
    const auto program = swarm.program("hive-sleeper").string();
    CHECK(swarm.hivectl_done({"rerun", "victim", "how=none", "--under", "/usr/bin/env"}, 30s)
              .ends_with("victim did not fail: emitted 1 event\n"));
    application.stop("victim");  // and its saved state is discarded
    CHECK(swarm.hivectl({"rerun", "victim"}).exit_code == 3);
    CHECK(swarm.hivectl_done({"rerun", "victim", "--kind", "sleeper"}, 30s)
          == "victim did not fail: emitted 1 event\n");
    CHECK(swarm.hivectl_done({"rerun", "victim", "--kind", "breaker", "--program", program}, 30s)
          == "victim did not fail: emitted 1 event\n");
    const auto wrong = swarm.hivectl({"rerun", "victim", "--kind", "breaker", "matched=true"}, 30s);
    CHECK(wrong.exit_code == 3);
    CHECK(has(wrong.err, "no input image"));
    CHECK(swarm.hivectl({"rerun", "unknown"}).exit_code == 3);
}

TEST_CASE("rerun: Ctrl-C ends the fresh drone and removes its home")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto victim = swarm.drone("breaker", "victim", {"how=throw", "from=1"});
    put_one(application, "victim");
    const OwnTemp temp(swarm);
    auto rerun = swarm.hivectl_running({"rerun", "victim", "how=hang"}, "rerun");
    REQUIRE(eventually([&] { return !temp.home("victim.sock").empty(); }));
    std::int64_t pid = 0;
    std::ifstream(temp.home("victim.sock") / "victim.lock") >> pid;
    REQUIRE(pid > 0);
    ::kill(rerun.pid(), SIGINT);
    CHECK(rerun.wait(test::patient(10s)).value_or(-1) == 130);
    CHECK(temp.empty());
    CHECK(eventually([&] { return ::kill(static_cast<pid_t>(pid), 0) != 0; }));
}

TEST_CASE("rerun: a file alone is enough, on a machine that knows nothing of the drone")
{
    const Swarm there, here;
    auto application = there.application();
    const auto file = there.home() / "saved" / "victim-1.failure";
    {
        auto victim = there.drone("breaker", "victim", {"how=throw", "from=1"});
        put_one(application, "victim");
        there.hivectl_done({"exceptions", "--save", file.parent_path().string()});
    }
    struct stat info {};
    REQUIRE(::stat(file.c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0600);
    const OwnTemp temp(here);
    const auto again = here.hivectl({"rerun", file.string(), "--json"}, 30s);
    CAPTURE(again.err);
    REQUIRE(again.exit_code == 9);
    const auto row = Json::parse(again.out);
    CHECK(row.at("outcome") == "threw");
    CHECK(row.at("rerun_text") == "broken, as told");
    CHECK(row.at("unfit").empty());
    CHECK(here.hivectl_done({"rerun", file.string(), "how=none"}, 30s) == "victim did not fail: emitted 1 event\n");

    const auto other = here.hivectl({"rerun", file.string(), "--kind", "sleeper"}, 30s);
    CHECK(other.exit_code == 0);
    CHECK(has(other.err, "this sleeper has no parameter how"));
    CHECK(temp.empty());
    const auto saved = here.home() / "again.failure";
    here.hivectl_done({"rerun", file.string(), "--save", saved.string()});
    CHECK(content(saved) == content(file));
    CHECK(here.hivectl({"rerun", file.string(), "--save", saved.string()}).exit_code == 5);  // exists
    for (const auto& useless : std::vector<std::vector<std::string>>{
             {"1"}, {"--on", "gpu1"}, {"--save", "-", "how=none"}, {"--save", "-", "--kind", "sleeper"}}) {
        std::vector<std::string> words{"rerun", file.string()};
        words.insert(words.end(), useless.begin(), useless.end());
        CHECK(here.hivectl(words).exit_code == 2);
    }

    auto renamed = content(file);  // the kind is a Python file, which is not taken from it; the parameters are
    renamed.replace(renamed.find("\"kind\":\"breaker\""), 16, "\"kind\":\"edge.py\"");
    const auto python = here.home() / "python.failure";
    std::ofstream(python, std::ios::binary) << renamed;
    CHECK(here.hivectl({"rerun", python.string()}).exit_code == 3);  // no such program
    const auto replaced = here.hivectl({"rerun", python.string(), "--kind", "breaker"}, 30s);
    CHECK_MESSAGE(replaced.out == "victim threw: failed: broken, as told\n", replaced.err);
}

TEST_CASE("rerun: values that affect the machine, such as logins, are neither written to a file nor taken from one")
{
    const Swarm swarm;
    auto application = swarm.application();
    const auto camera = swarm.drone("camera", "camera", {"credentials=me:secret", "fps=5"}, {"--halted"});
    KeptFailure failure{.drone = "camera", .code = "failed", .text = "no", .inputs = {}};
    const auto file = failure_file(application, failure);
    CHECK(has(file, "\"credentials\":null"));
    CHECK(!has(file, "secret"));
    CHECK(has(file, "\"fps\":5"));
    auto forged = file;
    forged.replace(forged.find("null"), 4, "\"xx\"");
    const auto path = swarm.home() / "forged.failure";
    std::ofstream(path, std::ios::binary) << forged;
    const auto done = swarm.hivectl({"rerun", path.string()}, 30s);
    CHECK_MESSAGE(done.exit_code == 0, done.err);
    CHECK(
        has(done.err, "credentials affects the machine, so it is not taken from the file; give it: credentials=VALUE"));
}

TEST_CASE("rerun: a file that is truncated, foreign, too large or not a file is refused with the reason")
{
    const Swarm swarm;
    auto application = swarm.application();
    const auto victim = swarm.drone("breaker", "victim", {"how=throw", "from=1"});
    put_one(application, "victim", 1000);
    const auto whole = failure_file(application, application.failures("victim", true).at(0));
    const auto file = swarm.home() / "bad.failure";
    const auto refused = [&](const std::string& bytes, const std::string& why) {
        std::ofstream(file, std::ios::binary) << bytes;
        const auto done = swarm.hivectl({"rerun", file.string()}, 30s);
        CAPTURE(done.err);
        CHECK(done.exit_code != 0);
        CHECK(done.exit_code != 9);
        CHECK(has(done.err, why));
        CHECK(has(done.err, "bad.failure"));
    };
    for (const auto size : {std::size_t(0), std::size_t(10), std::size_t(100), whole.size() / 2, whole.size() - 1})
        refused(whole.substr(0, size), "it ends too early");
    refused(whole + "x", "it has more bytes than its inputs");
    refused("\xff\xd8\xff not a failure at all, but an image", "not a Hive packet");
    auto lies = whole;
    lies.replace(12, 4, "\xff\xff\xff\x03", 4);  // a body of 64 MiB
    refused(lies, "");
    lies.replace(8, 4, "\xff\xff\xff\xff", 4);  // a header of 4 GiB
    refused(lies, "");
    std::filesystem::resize_file(file, 100 << 20);
    CHECK(has(swarm.hivectl({"rerun", file.string()}).err, "the file"));
    CHECK(has(swarm.hivectl({"rerun", (swarm.home() / "nowhere.failure").string()}).err, "cannot read "));
    REQUIRE(::mkfifo((swarm.home() / "pipe.failure").c_str(), 0600) == 0);
    CHECK(has(swarm.hivectl({"rerun", (swarm.home() / "pipe.failure").string()}).err, "not a regular file"));
}

TEST_CASE("rerun: a failure that another machine keeps is fetched over ssh, and leaves nothing behind")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto started =
        ssh.hivectl({"start", "breaker", "--on", "me@gpu1", "--as", "victim", "--insecure", "how=throw", "from=1"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    auto application = there.application();
    put_one(application, "victim", 20 << 20);  // more than a command may print
    const OwnTemp temp(here);
    const auto again = ssh.hivectl({"rerun", "victim"});
    CAPTURE(again.err);
    CHECK(again.exit_code == 9);
    CHECK(again.out == "victim threw: failed: broken, as told\n");
    CHECK(temp.empty());
    CHECK(ssh.hivectl({"rerun", "victim", "1", "how=none", "--on", "me@gpu1"}).exit_code == 0);
    const auto missing = ssh.hivectl({"rerun", "victim", "7"});
    CHECK(missing.exit_code == 3);
    CHECK(has(missing.err, "gpu1: of victim no failure 7 is kept, but 1"));
    CHECK(has(ssh.hivectl({"rerun", "victim", "--on", "bare"}).err, "no hivectl on bare"));
    CHECK(ssh.hivectl({"rerun", "victim", "--on", "unknown"}).exit_code == 4);
    CHECK(ssh.hivectl({"rerun", "victim", "--on", "-oProxyCommand=touch x"}).exit_code == 2);
    CHECK(ssh.hivectl({"rerun", "../victim", "--on", "me@gpu1"}).exit_code != 0);
    CHECK(temp.empty());
    CHECK(ssh.hivectl({"stop", "victim"}).exit_code == 0);
}

TEST_CASE("rerun: Ctrl-C while a failure is fetched ends ssh and removes what has come")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const OwnTemp temp(here);
    const auto words = ssh.words({"rerun", "victim", "--on", "me@gpu4"});  // which does not answer
    test::Process rerun(words, {"HIVE_HOME=" + here.home().string()}, here.home() / "rerun.log");
    std::filesystem::path directory;
    REQUIRE(eventually([&] { return !(directory = temp.home("fetched.failure")).empty(); }));
    struct stat info {};
    REQUIRE(::stat(directory.c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0700);
    REQUIRE(::stat((directory / "fetched.failure").c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0600);
    ::kill(rerun.pid(), SIGINT);
    CHECK(rerun.wait(test::patient(10s)).value_or(-1) == 130);
    CHECK(temp.empty());
}
