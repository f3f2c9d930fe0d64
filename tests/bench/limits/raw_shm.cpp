// What the machine allows through shared memory: a memfd of 8 slots, the numbers of the full ones in a ring, a futex to
// sleep on, and nothing else. The publisher takes the slot that was freed last: its lines are still in the cache.
//
//     bench_raw_shm copy  the image is copied from the camera's buffer into the slot
//     bench_raw_shm zc    the camera has written into the slot: only header and tail are stamped
#include "../harness/transport.hpp"
#include "segment.hpp"

namespace hive::bench {
namespace {

class ShmPublisher : public PushPublisher {
public:
    explicit ShmPublisher(const Run& run)
        : segment_(run.size, run.role), readers_(run.subscribers), in_place_(run.is("zc"))
    {
        for (std::uint32_t i = 0; i < slots; ++i)
            held_by_[i] = -1 - static_cast<std::int64_t>(i);
    }

private:
    void send(const Frame& frame) override
    {
        Control& control = segment_.control();
        await_slot(control);
        const auto slot = newest_free(slowest(control));
        held_by_[slot] = head_;
        control.slot_of[head_ % ring] = static_cast<std::uint8_t>(slot);
        segment_.put(frame, slot, in_place_);
        control.head = ++head_;
        if (control.sleepers > 0)
            futex_wake(control.head);
    }

    void await_slot(Control& control)
    {
        const auto full = [&] { return head_ - slowest(control) >= slots - 1; };
        while (full()) {
            const auto freed = control.freed.load();
            control.publisher_waits = 1;
            if (full())
                futex_wait(control.freed, freed, 100 * millisecond);
            control.publisher_waits = 0;
        }
    }

    [[nodiscard]] std::uint32_t slowest(const Control& control) const
    {
        std::uint32_t tail = head_;
        for (int i = 0; i < readers_; ++i)
            tail = std::min(tail, control.readers[static_cast<std::size_t>(i)].tail.load());
        return tail;
    }

    [[nodiscard]] std::uint32_t newest_free(std::int64_t read) const
    {
        std::uint32_t best = slots;
        for (std::uint32_t i = 0; i < slots; ++i)
            if (held_by_[i] < read && (best == slots || held_by_[i] > held_by_[best]))
                best = i;
        return best;
    }

    Segment segment_;
    int readers_;
    bool in_place_;
    std::uint32_t head_ = 0;
    std::array<std::int64_t, slots> held_by_{};  ///< the last frame in each slot
};

class ShmSubscriber : public Subscriber {
public:
    explicit ShmSubscriber(const Run& run) : segment_(run.size, run.role), index_(static_cast<std::size_t>(run.index))
    {
    }

    void receive(const OnFrame& on_frame) override
    {
        Control& control = segment_.control();
        Word& tail = control.readers[index_].tail;
        for (std::uint32_t next = tail;;) {
            while (control.head == next) {
                ++control.sleepers;
                futex_wait(control.head, next);
                --control.sleepers;
            }
            const bool more = on_frame(segment_.slot(control.slot_of[next % ring]));
            tail = ++next;
            if (control.publisher_waits > 0) {
                ++control.freed;
                futex_wake(control.freed);
            }
            if (!more)
                return;
        }
    }

private:
    Segment segment_;
    std::size_t index_;
};

class ShmServer : public Server {
public:
    explicit ShmServer(const Run& run) : segment_(run.size, run.role), in_place_(run.is("zc")) {}

    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        Control& control = segment_.control();
        Frame answer{};
        serving();
        for (std::uint32_t number = 1;; ++number) {
            await(control.requests, number, control.server_sleeps);
            const bool more = on_request(control.request, answer);
            segment_.put(answer, 0, in_place_);
            control.head = number;
            if (control.sleepers > 0)
                futex_wake(control.head);
            if (!more)
                return;
        }
    }

private:
    Segment segment_;
    bool in_place_;
};

class ShmClient : public Client {
public:
    explicit ShmClient(const Run& run) : segment_(run.size, run.role) {}

    bool ask(const Request& request, const FrameCheck& check) override
    {
        Control& control = segment_.control();
        control.request = request;
        control.requests = ++number_;
        if (control.server_sleeps > 0)
            futex_wake(control.requests);
        await(control.head, number_, control.sleepers);
        return check.whole(segment_.slot(0));
    }

private:
    Segment segment_;
    std::uint32_t number_ = 0;
};

class RawShm : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return std::make_unique<ShmPublisher>(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<ShmSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<ShmServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<ShmClient>(run); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("raw_shm", hive::bench::RawShm(), argc, argv); }
