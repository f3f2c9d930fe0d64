// Tests the bad link itself: compares the packets sent at one end with those received at the other.
#include "bad_link.hpp"
#include "lab.hpp"
#include "network_space.hpp"

#include <possible.hpp>

#include <algorithm>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint16_t port = 7000;
constexpr std::size_t size = 400;

sockaddr_in at(const std::string& host)
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    return address;
}

/// A socket for datagrams on each of two machines.
class Post {
public:
    Post(const Machine& from, const Machine& to) : to_(at(to.address)), sending_(open(from)), receiving_(open(to))
    {
        const int enough = 16 << 20;  // for everything that is sent before the first receive
        ::setsockopt(receiving_, SOL_SOCKET, SO_RCVBUFFORCE, &enough, sizeof enough);
    }
    ~Post()
    {
        ::close(sending_);
        ::close(receiving_);
    }
    Post(const Post&) = delete;
    Post& operator=(const Post&) = delete;

    struct Result {
        std::vector<int> numbers;
        int damaged = 0;
        Clock::duration fastest = Clock::duration::max();
    };
    /// Sends this many, one after the other, and returns those received: waits for the expected number, and then until
    /// none has arrived for a while.
    Result exchange(int datagrams, int expected, Milliseconds quiet = 300ms) const
    {
        std::vector<Clock::time_point> sent;
        for (int number = 0; number < datagrams; ++number) {
            sent.push_back(Clock::now());
            send(number);
            std::this_thread::sleep_for(100us);  // so that no queue of the kernel overflows
        }
        Result result;
        unsigned char bytes[size];
        for (int came = 0;; ++came) {
            wait_for(came < expected ? patient(5000ms) : quiet);
            if (::recv(receiving_, bytes, size, 0) != static_cast<ssize_t>(size))
                break;
            int number = 0;
            std::memcpy(&number, bytes, sizeof number);
            const bool whole =
                number >= 0 && number < datagrams && std::equal(bytes, bytes + size, text(number).begin());
            result.damaged += whole ? 0 : 1;
            if (!whole)
                continue;
            result.numbers.push_back(number);
            result.fastest = std::min(result.fastest, Clock::now() - sent[static_cast<std::size_t>(number)]);
        }
        return result;
    }

private:
    static int open(const Machine& machine)
    {
        return inside_network(machine.net.name(), [&] {
            const int opened = require_descriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), "socket");
            const auto here = at(machine.address);
            require_descriptor(::bind(opened, reinterpret_cast<const sockaddr*>(&here), sizeof here), "bind");
            return opened;
        });
    }
    static std::vector<unsigned char> text(int number)
    {
        std::vector<unsigned char> bytes(size);
        for (std::size_t i = 0; i < size; ++i)
            bytes[i] = static_cast<unsigned char>(i);
        std::memcpy(bytes.data(), &number, sizeof number);
        return bytes;
    }
    /// How long recv() waits.
    void wait_for(Milliseconds time) const
    {
        const timeval timeout{time.count() / 1000, time.count() % 1000 * 1000};
        ::setsockopt(receiving_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    }
    void send(int number) const
    {
        const auto bytes = text(number);
        ::sendto(sending_, bytes.data(), size, 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    }

    sockaddr_in to_;
    int sending_, receiving_;
};

}  // namespace

TEST_CASE("bad link: packets are delayed, lost, doubled, disordered and damaged as they are told to be")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"one", "two"});
    BadLink link(lab.machine(0), lab.machine(1));
    const Post post(lab.machine(0), lab.machine(1));
    const auto good = post.exchange(200, 200);
    CHECK(good.numbers.size() == 200);
    CHECK(std::ranges::is_sorted(good.numbers));

    link.set({.delay = 60ms});
    const auto late = post.exchange(50, 50);
    CHECK(late.numbers.size() == 50);
    CHECK(late.fastest >= 60ms);

    link.set({.loss = 0.25});
    const auto lossy = post.exchange(1000, 0, 2s).numbers.size();
    CHECK(lossy > 650);
    CHECK(lossy < 850);

    link.set({.delay = 20ms, .jitter = 20ms, .duplication = 0.25});
    auto twice = post.exchange(400, 400, 2s).numbers;
    CHECK_FALSE(std::ranges::is_sorted(twice));
    CHECK(twice.size() > 440);
    std::ranges::sort(twice);
    CHECK(std::ranges::unique(twice).begin() - twice.begin() == 400);

    link.set({.corruption = 0.5, .damage = LineQuality::Damage::bit});
    const auto seen = post.exchange(400, 0, 2s);
    CHECK(seen.damaged == 0);  // the checksum sees one bit
    CHECK(seen.numbers.size() < 300);
    link.set({.corruption = 0.5, .damage = LineQuality::Damage::words});
    CHECK(post.exchange(400, 0, 2s).damaged > 100);

    link.set({.megabits = 4, .buffer_bytes = 1'000'000});  // 400 of 428 bytes take 0.34 s
    const auto begin = Clock::now();
    CHECK(post.exchange(400, 400).numbers.size() == 400);
    CHECK(Clock::now() - begin >= 340ms);
    link.swallow();
    CHECK(post.exchange(50, 0).numbers.empty());
    CHECK(link.counts().lost > 200);
}
