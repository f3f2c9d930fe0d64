// Connects two TUN devices with a thread.
#include "bad_link.hpp"

#include "network_space.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace hive::test {
namespace {

constexpr const char* device = "bad";

/// A TUN device of a machine, with the route to the other one.
class Tun {
public:
    Tun(const Machine& here, const Machine& there) : descriptor_(inside_network(here.net.name(), open_device))
    {
        here.net.run("ip link set " + std::string(device) + " mtu 1500 txqueuelen 1000 up; ip route add "
                     + there.address + "/32 dev " + device + " src " + here.address);
    }
    ~Tun() { ::close(descriptor_); }  // removes the device and its route
    Tun(const Tun&) = delete;
    Tun& operator=(const Tun&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    std::optional<Line::Packet> read()
    {
        const auto size = ::read(descriptor_, space_.data(), space_.size());
        if (size <= 0)
            return std::nullopt;
        return Line::Packet(space_.begin(), space_.begin() + size);
    }
    void write(const Line::Packet& packet)
    {
        static_cast<void>(!::write(descriptor_, packet.data(), packet.size()));  // a network may lose packets
    }

private:
    static int open_device()
    {
        const int opened =
            require_descriptor(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC), "cannot open /dev/net/tun");
        ifreq request{};
        request.ifr_flags = IFF_TUN | IFF_NO_PI;
        std::strncpy(request.ifr_name, device, IFNAMSIZ - 1);
        require_descriptor(::ioctl(opened, TUNSETIFF, &request), "cannot make a TUN device");
        return opened;
    }

    int descriptor_;
    std::array<unsigned char, 65536> space_{};
};

}  // namespace

class BadLink::Impl {
public:
    Impl(const Machine& one, const Machine& other, const LineQuality& quality, std::uint64_t seed)
        : ends_{std::make_unique<Tun>(one, other), std::make_unique<Tun>(other, one)},
          lines_{Line(2 * seed), Line(2 * seed + 1)},
          quality_(quality),
          thread_([this] { run(); })
    {
    }
    ~Impl()
    {
        stopping_ = true;
        thread_.join();
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void set(const LineQuality& quality)
    {
        const std::lock_guard lock(mutex_);
        quality_ = quality;
    }
    LineCounts counts()
    {
        const std::lock_guard lock(mutex_);
        LineCounts sum = lines_[0].counts();
        const auto& other = lines_[1].counts();
        sum.came += other.came;
        sum.lost += other.lost;
        sum.overflowed += other.overflowed;
        sum.duplicated += other.duplicated;
        sum.damaged += other.damaged;
        return sum;
    }

private:
    void run()
    {
        while (!stopping_) {
            wait();
            const std::lock_guard lock(mutex_);
            for (const std::size_t from : {0, 1})
                carry(from);
        }
    }
    void wait()
    {
        using namespace std::chrono_literals;
        auto until = Clock::now() + 20ms;  // then it checks for the end
        for (const auto& line : lines_)
            until = std::min(until, line.next().value_or(until));
        const auto time = std::max<Clock::duration>(until - Clock::now(), 0ns);
        const timespec timeout{0, std::chrono::nanoseconds(time).count()};
        std::array<pollfd, 2> watched{pollfd{ends_[0]->descriptor(), POLLIN, 0},
                                      pollfd{ends_[1]->descriptor(), POLLIN, 0}};
        ::ppoll(watched.data(), watched.size(), &timeout, nullptr);
    }
    void carry(std::size_t from)
    {
        constexpr int at_once = 64;  // then the other direction has its turn
        auto& line = lines_.at(from);
        for (int i = 0; i < at_once; ++i)
            if (auto packet = ends_.at(from)->read())
                line.come(std::move(*packet), quality_, Clock::now());
            else
                break;
        while (const auto packet = line.arrived(Clock::now()))
            ends_.at(1 - from)->write(*packet);
    }

    std::array<std::unique_ptr<Tun>, 2> ends_;
    std::mutex mutex_;  ///< of the lines and their quality
    std::array<Line, 2> lines_;
    LineQuality quality_;
    std::atomic<bool> stopping_ = false;
    std::thread thread_;
};

BadLink::BadLink(const Machine& one, const Machine& other, const LineQuality& quality, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(one, other, quality, seed))
{
}
BadLink::~BadLink() = default;
void BadLink::set(const LineQuality& quality) { impl_->set(quality); }
LineCounts BadLink::counts() const { return impl_->counts(); }

}  // namespace hive::test
