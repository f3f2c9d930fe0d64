// Addresses that are free, taken, stale, dead or forbidden.
#include "transport_world.hpp"

#include <possible.hpp>

#include <fcntl.h>
#include <fstream>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace world;

namespace {

/// The deadline of a dial that is to succeed or to be refused: passed only by one that hangs.
constexpr auto in_time = 60s;

struct Answer {
    bool given = false;
    bool connected = false;
    Errc code{};
    std::string text;
};

Answer dial(Loop& loop, const Address& address, std::chrono::milliseconds deadline)
{
    Answer answer;
    hive::transport::dial(loop.context, address, deadline, [&](auto connection) {
        answer.given = true;
        answer.connected = value_or_none(connection) != nullptr;
        if (const auto* failure = error_of(connection)) {
            answer.code = failure->code();
            answer.text = failure->what();
        }
    });
    CHECK_FALSE(answer.given);  // never from inside
    REQUIRE(loop.until([&] { return answer.given; }, 2 * in_time));
    return answer;
}

std::unique_ptr<hive::transport::Listener> listen(Loop& loop, const Address& address)
{
    return hive::transport::listen(loop.context, address, [](auto) {});
}

Errc listen_error(Loop& loop, const Address& address, std::string* text = nullptr)
{
    try {
        listen(loop, address);
    } catch (const hive::Error& error) {
        if (text)
            *text = error.what();
        return error.code();
    }
    FAIL("listening succeeded");
    return {};
}

/// A listening socket of nobody: its queue is as short as it can be, and nobody accepts.
int bind_raw(const std::string& path)
{
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    REQUIRE(::bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(descriptor, 0) == 0);
    return descriptor;
}

Address unix_at(const std::string& path) { return {Address::Scheme::unix_socket, path, 0}; }

}  // namespace

TEST_CASE_TEMPLATE("place: dialing where nobody listens is unreachable, with the address in the text", Place, Unix, Tcp)
{
    Loop loop;
    Folder folder;
    const auto address = [&] { return listen(loop, Place::address(folder))->address(); }();  // was free, is free again
    const auto answer = dial(loop, address, in_time);
    CHECK(answer.code == Errc::unreachable);
    CHECK(answer.text.find(to_text(address)) != std::string::npos);
}

TEST_CASE_TEMPLATE("place: a second listener at one place is refused and the first goes on", Place, Unix, Tcp)
{
    Loop loop;
    Folder folder;
    const auto first = listen(loop, Place::address(folder));
    std::string text;
    CHECK(listen_error(loop, first->address(), &text) == Errc::name_taken);
    CHECK(text.find(to_text(first->address())) != std::string::npos);
    CHECK(dial(loop, first->address(), in_time).connected);
}

TEST_CASE_TEMPLATE("place: a listener that is gone accepts nobody, and its place can be taken again", Place, Unix, Tcp)
{
    Loop loop;
    Folder folder;
    auto first = listen(loop, Place::address(folder));
    const auto address = first->address();
    CHECK(dial(loop, address, in_time).connected);
    first.reset();
    CHECK(dial(loop, address, in_time).code == Errc::unreachable);
    const auto second = listen(loop, address);
    CHECK(dial(loop, address, in_time).connected);
}

TEST_CASE("place: a dial to a unix socket whose queue is full keeps its deadline")
{
    Loop loop;
    Folder folder;
    const int listening = bind_raw(folder.path("full"));
    const int filling = connect_raw(unix_at(folder.path("full")));
    const auto begin = std::chrono::steady_clock::now();
    const auto answer = dial(loop, unix_at(folder.path("full")), 100ms);
    CHECK(answer.code == Errc::timeout);
    CHECK(answer.text.find("100 ms") != std::string::npos);
    CHECK(std::chrono::steady_clock::now() - begin >= 100ms);
    CHECK(listen_error(loop, unix_at(folder.path("full"))) == Errc::name_taken);  // a full queue is alive
    ::close(filling);
    ::close(listening);
}

TEST_CASE("place: a dial to a tcp port that does not answer keeps its deadline")
{
    Loop loop;
    const int listening = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    REQUIRE(::bind(listening, reinterpret_cast<sockaddr*>(&at), size) == 0);
    REQUIRE(::listen(listening, 0) == 0);
    REQUIRE(::getsockname(listening, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    const Address address{Address::Scheme::tcp, "127.0.0.1", ntohs(at.sin_port)};
    const int filling = connect_raw(address);
    const auto answer = dial(loop, address, 150ms);
    CHECK(answer.code == Errc::timeout);
    ::close(filling);
    ::close(listening);
}

TEST_CASE("place: host names are looked up, and a name that does not exist is answered by the deadline")
{
    Loop loop;
    const auto listener = listen(loop, {Address::Scheme::tcp, "127.0.0.1", 0});
    CHECK(dial(loop, {Address::Scheme::tcp, "localhost", listener->address().port}, in_time).connected);
    const auto answer = dial(loop, {Address::Scheme::tcp, "no-such-host.invalid", 1}, 500ms);
    CHECK((answer.code == Errc::unreachable || answer.code == Errc::timeout));
    CHECK(answer.text.find("no-such-host.invalid") != std::string::npos);
}

TEST_CASE("place: a taken tcp port is named")
{
    Loop loop;
    const auto first = listen(loop, {Address::Scheme::tcp, "127.0.0.1", 0});
    std::string text;
    listen_error(loop, first->address(), &text);
    CHECK(text.find("port " + std::to_string(first->address().port) + " is taken") != std::string::npos);
}

TEST_CASE("place: a stale socket file is replaced, and has mode 0600")
{
    Loop loop;
    Folder folder;
    const auto path = folder.path("stale");
    ::close(bind_raw(path));
    REQUIRE(std::filesystem::exists(path));
    const auto listener = listen(loop, unix_at(path));
    struct stat found {};
    REQUIRE(::stat(path.c_str(), &found) == 0);
    CHECK((found.st_mode & 0777) == 0600);
    CHECK(dial(loop, unix_at(path), in_time).connected);
}

TEST_CASE("place: a file that is no socket is left alone")
{
    Loop loop;
    Folder folder;
    std::ofstream(folder.path("file")) << "precious";
    CHECK(listen_error(loop, unix_at(folder.path("file"))) == Errc::name_taken);
    CHECK(std::filesystem::file_size(folder.path("file")) == 8);
}

TEST_CASE("place: a listener removes its own socket file only")
{
    Loop loop;
    Folder folder;
    const auto path = folder.path("moved");
    auto first = listen(loop, unix_at(path));
    std::filesystem::rename(path, folder.path("elsewhere"));
    const auto second = listen(loop, unix_at(path));
    first.reset();
    CHECK(std::filesystem::exists(path));
    CHECK(dial(loop, unix_at(path), in_time).connected);
}

TEST_CASE("place: a path that is too long, a folder that is missing and an unknown host are refused clearly")
{
    Loop loop;
    Folder folder;
    const auto path = unix_at(folder.path(std::string(200, 'x')));
    CHECK(listen_error(loop, path) == Errc::invalid_argument);
    CHECK(dial(loop, path, 1s).code == Errc::invalid_argument);
    std::string text;
    CHECK(listen_error(loop, unix_at(folder.path("no/folder")), &text) == Errc::io);
    CHECK(text.find("folder") != std::string::npos);
}

TEST_CASE("place: a peer of another user is closed by the listener and refused by the dialer (needs root)")
{
    if (!hive::test::possible(::geteuid() == 0 ? "" : "root, to become another user"))
        return;
    Folder folder;
    Loop loop;
    int welcomed = 0;
    const auto listener =
        hive::transport::listen(loop.context, unix_at(folder.path("open")), [&](auto) { ++welcomed; });
    std::filesystem::permissions(std::filesystem::path(folder.path("open")).parent_path(), std::filesystem::perms::all);
    std::filesystem::permissions(folder.path("open"), std::filesystem::perms::all);
    const pid_t child = ::fork();
    if (child == 0) {
        if (::setuid(65534) != 0)
            ::_exit(3);
        const auto descriptor = connect_raw(unix_at(folder.path("open")));
        char byte = 0;
        if (::read(descriptor, &byte, 1) != 0)  // the end, not data
            ::_exit(4);
        Loop own;
        ::_exit(dial(own, unix_at(folder.path("open")), in_time).code == Errc::not_permitted ? 0 : 5);
    }
    int status = -1;
    REQUIRE(loop.until([&] { return ::waitpid(child, &status, WNOHANG) == child; }));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(welcomed == 0);
}
