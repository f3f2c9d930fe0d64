// Starting the drone under test, with and without a home.
#include "subject.hpp"

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sstream>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace subject {

namespace fs = std::filesystem;

namespace {

std::string told(const char* variable)
{
    const char* value = std::getenv(variable);
    if (!value)
        throw std::runtime_error(std::string(variable) + " is not set: which drone is to be tested?");
    return value;
}

std::string text_of(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class Folder {
public:
    Folder()
    {
        std::string pattern = (fs::temp_directory_path() / "hive-contract-XXXXXX").string();
        if (!::mkdtemp(pattern.data()))
            throw std::runtime_error("cannot make " + pattern);
        path = pattern;
    }
    ~Folder()
    {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    fs::path path;
};

}  // namespace

fs::path program() { return told("HIVE_CONTRACT_PROGRAM"); }
fs::path folder() { return told("HIVE_CONTRACT_FOLDER"); }
Milliseconds within(int milliseconds) { return Milliseconds(3 * milliseconds); }

Ended run(const std::vector<std::string>& words, const std::vector<std::string>& environment)
{
    const Folder folder;
    hive::test::Process process(words, environment, folder.path / "log");
    const auto exit_code = process.wait(Milliseconds(20'000));
    process.kill();
    return {exit_code.value_or(-1), text_of(folder.path / "log")};
}

Ended run_offline(const std::vector<std::string>& arguments)
{
    std::vector<std::string> words{fs::read_symlink("/proc/self/exe"), "--without-sockets", program()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run(words, {"HIVE_HOME=/dev/null/home"});
}

const Json& description()
{
    static const Json json = Json::parse(run_offline({"--describe"}).output);
    return json;
}

std::vector<std::string> image_inputs()
{
    std::vector<std::string> names;
    for (const auto& input : description().at("inputs"))
        if (input.at("type").get<std::string>().find("image/jpeg") != std::string::npos)
            names.push_back(input.at("name"));
    return names;
}

std::string written(double number)
{
    std::ostringstream text;
    text.precision(15);
    text << number;
    return text.str();
}

hive::test::Process Home::launch(const std::vector<std::string>& arguments, const std::string& log) const
{
    std::vector<std::string> words{program(), "--name", "subject"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return {words, {"HIVE_HOME=" + swarm_.home().string()}, swarm_.home() / log};
}

hive::test::Process Home::start(const std::vector<std::string>& arguments) const
{
    auto process = launch(arguments);
    if (!hive::test::eventually([&] { return answers(); }, within(5000)))
        throw std::runtime_error("the drone does not answer: " + log());
    return process;
}

bool Home::answers() const
{
    try {
        static_cast<void>(meet());
        return true;
    } catch (const std::runtime_error&) {
        return false;
    }
}

std::string Home::log(const std::string& log) const { return text_of(swarm_.home() / log); }

int run_without_sockets(char** words)
{
    sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_socket, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog filter{std::size(rules), rules};
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)
        std::perror("without the kernel's filter of system calls");
    ::execv(words[0], words);
    std::perror(words[0]);
    return 127;
}

}  // namespace subject
