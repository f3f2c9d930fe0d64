// A source, drones behind it and a collector, as plain objects in one process: the receiver tables of their outputs,
// the inputs of their receivers with tickets and filters, and what is under way between them. Connections break, which
// one end may notice late, change their options and their group; drones die with all they have and restart, members of
// groups hand back. Whatever happens, an input is given no more than it allows, of what must arrive each event gets one
// result or is reported, nothing gets two results, and nothing stalls.
#include "random_steps.hpp"

#include <hive/event/answer_filter.hpp>
#include <hive/event/input_progress.hpp>
#include <hive/event/receiver_table.hpp>
#include <hive/event/ticket.hpp>

#include <deque>
#include <list>
#include <memory>
#include <set>

namespace hive::event {
namespace {

using namespace random;
using namespace std::chrono_literals;

class ChainWalk {
public:
    ChainWalk(Dice& dice, std::size_t hops) : dice_(dice), hops_(hops) { begin(); }

    void step()
    {
        const auto kind = dice_.between(1, 1000);
        Line& line = *dice_.one_of(lines_);
        if (kind <= 200)
            produce();
        else if (kind <= 450)
            down(line);
        else if (kind <= 650)
            up(line);
        else if (kind <= 940)
            process(line);
        else if (kind <= 965)
            line.connected ? cut(line, dice_.yes(50)) : come_back(line);
        else if (kind <= 970)
            change(line);
        else if (kind <= 975)
            regroup(line);
        else if (kind <= 980)
            kill(line.to);
        else if (kind <= 998)
            pass(std::chrono::milliseconds(dice_.between(1, 2000)));
        else
            end();
        hear_told();
    }

    void check() const
    {
        for (const auto& drone : drones_)
            for (const auto& row : drone.out ? drone.out->rows() : std::vector<ReceiverTable::Row>())
                hold(balanced(row.status.events), "the accounts balance");
    }

private:
    struct Drone {
        std::string name;
        std::unique_ptr<ReceiverTable> out{};  ///< none: it collects
        std::int64_t epoch = 1, turns = 0;
        std::shared_ptr<int> life = std::make_shared<int>(0);
    };
    struct Arrival {
        std::int64_t generation, number;
        Event event;
    };
    struct Line {  ///< from an output to an input
        Drone* from;
        Drone* to;
        ConnectionOptions options;
        bool alone = false;  ///< no other drone gets events from there, so it may share them or not
        ReceiverId id = 0;   ///< 0: the sender knows that the connection ended
        std::int64_t registration = 0;
        bool connected = false, retired = false, left = false;
        InputProgress progress{};
        std::deque<Send> down{};
        std::deque<protocol::Request> up{};
        std::deque<Arrival> arrived{};
        Clock::time_point lost_at{};
        [[nodiscard]] bool shared() const { return !options.group.empty(); }
        [[nodiscard]] std::int64_t window() const
        {
            return options.transfer == Transfer::streaming ? Credit::most_streamed : options.window;
        }
    };
    struct Told {  ///< that an event may be acknowledged
        Line* line;
        std::weak_ptr<int> life;
        std::int64_t generation, number;
    };

    /// One source, some layers of one drone or a group, one collector.
    void begin()
    {
        drones_.clear();
        lines_.clear();
        told_.clear();
        owed_.clear();
        reported_.clear();
        results_.clear();
        filter_ = {};
        regrouped_ = false;
        std::vector<Drone*> layer{&drones_.emplace_back(Drone{.name = "source"})};
        for (std::size_t hop = 1; hop <= hops_; ++hop) {
            const auto size = hop == hops_ ? 1 : dice_.between(1, 3);
            std::vector<Drone*> next;
            for (std::int64_t i = 0; i < size; ++i)
                next.push_back(&drones_.emplace_back(Drone{.name = "d" + std::to_string(drones_.size())}));
            const auto options = any_options(size > 1);
            for (Drone* from : layer) {
                from->out = output_of(*from);
                for (Drone* to : next)
                    lines_.push_back({.from = from, .to = to, .options = options, .alone = size == 1});
            }
            layer = std::move(next);
        }
        for (Line& line : lines_)
            come_back(line);
    }
    [[nodiscard]] static std::unique_ptr<ReceiverTable> output_of(const Drone& drone)
    {
        return std::make_unique<ReceiverTable>(drone.name + ".out", drone.epoch);
    }
    [[nodiscard]] ConnectionOptions any_options(bool shared)
    {
        return shared          ? sharing(500ms, static_cast<int>(dice_.between(1, 3)))
               : dice_.yes(30) ? streaming()
                               : window(static_cast<int>(dice_.between(1, 4)));
    }

    void produce()
    {
        Drone& source = drones_.front();
        Event event;
        event.identity = {.source = source.name, .epoch = 1, .sequence = ++sequence_, .lossless = dice_.yes(70)};
        if (event.identity.lossless && source.out->awaited())
            owed_.insert(sequence_);
        emit(source, std::move(event));
    }
    void emit(Drone& from, Event event)
    {
        event.sender = from.name;
        event.kind = "drone";
        event.output = "out";
        event.type = "image/jpeg";
        std::optional<Share> own;
        if (event.identity.lossless)
            own = Share{.of = from.name + ".out", .epoch = from.epoch, .turn = ++from.turns};
        const auto emission = std::make_shared<const Emission>(std::move(event), true, own);
        decide(from, [&](Decisions& to) { from.out->offer(emission, false, now_, to); });
    }

    /// The next event arrives.
    void down(Line& line)
    {
        if (line.down.empty())
            return;
        const Send send = std::move(line.down.front());
        line.down.pop_front();
        Event event = send.event->event();
        hold(line.progress.allows(event.identity.lossless), "an input is given no more than it allows");
        const auto number = line.progress.receive(event.identity.lossless, 0);
        const auto& share = send.share ? send.share : send.event->own();
        if (share)
            event.identity.shares.push_back(*share);
        event.input = "in";
        event.ticket = ticket(line, line.progress.generation(), number);
        line.arrived.push_back({line.progress.generation(), number, std::move(event)});
        hold(std::ssize(line.arrived) <= line.window() || !send.event->lossless(),
             "an input has no more than its window in hand, however often it registers");
        decide(*line.from, [&](Decisions& to) { line.from->out->written(line.id, send.event->size(), now_, to); });
        flush(line);
    }
    /// When the last one is gone, the event is acknowledged, unless its drone has died meanwhile.
    Ticket ticket(Line& line, std::int64_t generation, std::int64_t number)
    {
        const std::weak_ptr<int> life = line.to->life;
        const auto tell = [this, &line, life, generation, number](Acknowledgement* owed) {
            delete owed;
            told_.push_back({&line, life, generation, number});
        };
        return {{new Acknowledgement, tell}, true};
    }
    void hear_told()
    {
        for (; !told_.empty(); told_.pop_front())
            if (const auto& told = told_.front(); !told.life.expired()) {
                told.line->progress.heard(told.generation, told.number, false, true, false);
                flush(*told.line);
            }
    }

    /// The sender hears a request.
    void up(Line& line)
    {
        if (line.up.empty())
            return;
        const auto request = std::move(line.up.front());
        line.up.pop_front();
        decide(*line.from, [&](Decisions& to) {
            line.from->out->request(line.id, line.registration, {request.id, request.worked, request.done},
                                    request.back, now_, to);
        });
    }

    /// The oldest is processed; a member may hand it back instead.
    void process(Line& line)
    {
        if (line.arrived.empty() || (line.to->out && !line.to->out->awaited()))
            return;
        const Arrival arrival = std::move(line.arrived.front());
        line.arrived.pop_front();
        const bool back = line.shared() && dice_.yes(5);
        if (!back)
            line.to->out ? pass_on(*line.to, arrival.event) : collect(arrival.event);
        line.progress.heard(arrival.generation, arrival.number, true, false, back);
        flush(line);
    }
    void pass_on(Drone& drone, const Event& event)
    {
        Event result;
        result.identity = event.identity;
        if (event.identity.lossless)
            result.ticket = event.ticket.of_cause();
        emit(drone, std::move(result));
    }
    void collect(const Event& event)
    {
        if (filter_.first(event))
            hold(results_.insert(event.identity.sequence).second || (regrouped_ && !event.identity.lossless),
                 "nothing gets two results");
    }

    /// A drone whose results wait asks for nothing.
    [[nodiscard]] static bool may_ask(const Line& line)
    {
        return !line.retired && (!line.to->out || !line.to->out->demand().backlogged);
    }
    void flush(Line& line, bool late = false)
    {
        if (!line.connected)
            return;
        if (auto news = line.progress.news(may_ask(line), late))
            line.up.push_back(std::move(*news));
        if (line.retired && line.progress.empty())
            leave(line);
    }

    /// The connection between two drones. @param noticed  by the sender, at once
    void cut(const Line& between, bool noticed)
    {
        for (Line& line : lines_)
            if (line.from == between.from && line.to == between.to)
                end(line, Fate::lost_connection, noticed);
    }
    void end(Line& line, Fate how, bool noticed)
    {
        line.down.clear();
        line.up.clear();
        if (!std::exchange(line.connected, false))
            return;
        line.lost_at = now_;
        line.left = line.retired;
        if (noticed || line.retired)
            notice(line, how);
    }
    void notice(Line& line, Fate how)
    {
        decide(*line.from,
               [&, id = std::exchange(line.id, 0)](Decisions& to) { line.from->out->lose(id, how, true, now_, to); });
    }
    /// It registers again, and says what it has. Its place is kept while the source waits for it.
    void come_back(Line& line)
    {
        if (!line.connected && !line.left)
            enrol(line, false);
    }
    /// @param drains  on the same connection
    void enrol(Line& line, bool drains)
    {
        const auto place = line.progress.place(), held = line.progress.held(may_ask(line));
        const bool owes = line.progress.lossless_in_hand();
        const Newcomer newcomer{.id = ++last_id_,
                                .receiver = line.to->name + ".in",
                                .epoch = ++registrations_,
                                .options = line.options,
                                .place = place,
                                .taken = place != 0 ? std::optional(line.progress.arrived()) : std::nullopt,
                                .held = held,
                                .tried = registrations_,
                                .run = line.to->epoch,
                                .unique = true,
                                .drains = drains};
        line.id = newcomer.id;
        line.registration = newcomer.epoch;
        line.connected = true;
        decide(*line.from, [&](Decisions& to) {
            const auto welcome = line.from->out->add(newcomer, now_, to);
            const bool goes_on = line.progress.begin(newcomer.epoch, line.options, welcome.place, welcome.taken, held);
            hold(goes_on || place == 0 || !owes, "who comes back in time goes on where it was");
        });
        flush(line);
    }

    void hear_all(Line& line)
    {
        while (!line.up.empty())
            up(line);
    }
    /// It registers again with another window or transfer; what is under way to it is sent again.
    void change(Line& line)
    {
        if (!line.connected || line.retired)
            return;
        hear_all(line);
        line.down.clear();
        const auto group = line.options.group;
        line.options = any_options(line.shared());
        line.options.group = group;
        enrol(line, true);
    }
    /// It joins a group, or leaves its group: it finishes what it has.
    void regroup(Line& line)
    {
        if (!line.alone || !line.to->out || line.left || line.retired)
            return;
        regrouped_ = true;
        Line& other = lines_.emplace_back(
            Line{.from = line.from, .to = line.to, .options = any_options(!line.shared()), .alone = true});
        const bool drains = line.connected;
        if (drains)
            hear_all(line);
        line.retired = true;
        line.left = !drains;
        enrol(other, drains);
        flush(line);
    }
    void leave(Line& line)
    {
        hear_all(line);
        line.connected = false;
        line.left = true;
        line.down.clear();
        decide(*line.from, [&](Decisions& to) { line.from->out->leave(line.id, now_, to); });
    }

    /// A drone dies with all that it has, and runs again. It knows from its state whom it served.
    void kill(Drone* drone)
    {
        if (!drone->out)
            return;
        drone->life = std::make_shared<int>(0);
        ++drone->epoch;
        drone->turns = 0;
        for (Line& line : lines_)
            if (line.to == drone) {
                end(line, Fate::lost_killed, true);
                if (line.id != 0)
                    notice(line, Fate::lost_killed);  // from the next run, at the latest
                line.arrived.clear();
                line.progress = {};
            } else if (line.from == drone) {
                line.connected = false;
                line.left = line.left || line.retired;
                line.id = 0;
                line.down.clear();
                line.up.clear();
                line.lost_at = now_;
                line.progress.lose_place();
            }
        const auto before = std::exchange(drone->out, output_of(*drone));
        for (const auto& subscriber : before->subscribers())
            drone->out->expect(subscriber,
                               subscriber.group.empty() ? std::optional(now_ + Subscription::kept_for) : std::nullopt);
    }

    void pass(Clock::duration time)
    {
        now_ += time;
        for (Line& line : lines_) {
            if (!line.connected && line.id != 0 && !line.left && now_ > line.lost_at + 5s)
                notice(line, Fate::lost_cut_off);
            if (!line.connected && now_ > line.lost_at + Subscription::kept_for - 5s)
                come_back(line);
        }
        for (Drone& drone : drones_)
            if (drone.out)
                decide(drone, [&](Decisions& to) { drone.out->tick(now_, to); });
        for (Line& line : lines_)
            flush(line, true);
    }

    /// Everybody is there and deals with everything.
    void end()
    {
        const auto busy = [](const Drone& drone) {
            return drone.out && std::ranges::any_of(drone.out->rows(), [](const auto& row) {
                       return row.status.events.in_flight() > 0;
                   });
        };
        for (int round = 0; round == 0 || std::ranges::any_of(drones_, busy); ++round) {
            hold(round < 20'000, "nothing stalls when all deal with what they get");
            for (Line& line : lines_) {
                come_back(line);
                while (!line.down.empty())
                    down(line);
                for (auto left = line.arrived.size(); left > 0; --left)
                    process(line);
                hear_all(line);
            }
            hear_told();
            pass(1ms);
        }
        for (const auto sequence : owed_)
            hold(results_.contains(sequence) || reported_.contains(sequence),
                 "what must arrive has a result, or failed");
        begin();
    }

    template <class Call>
    void decide(Drone& from, Call call)
    {
        const auto decisions = decided(call);
        for (const auto& send : decisions.sends) {
            const auto line = std::ranges::find(lines_, send.receiver, &Line::id);
            hold(line != lines_.end(), "only a registered receiver is sent an event");
            if (line->connected)
                line->down.push_back(send);
        }
        for (const auto& event : decisions.failed)
            reported_.insert(sequence_of(event));
        for (Line& line : lines_)
            if (line.to == &from)
                flush(line);
    }

    Dice& dice_;
    std::size_t hops_;
    std::set<std::int64_t> owed_, reported_, results_;
    AnswerFilter filter_;  ///< of the collector
    Clock::time_point now_ = start;
    ReceiverId last_id_ = 0;
    std::int64_t sequence_ = 0, registrations_ = 0;
    /// Of a live event that is dispatched again, a second result may have one share more, so the filter does not
    /// recognise it.
    bool regrouped_ = false;
    std::deque<Told> told_;  // outlives what holds tickets
    std::list<Line> lines_;
    std::list<Drone> drones_;
};

}  // namespace

TEST_CASE("chain: a hundred thousand random steps over one, two and three hops break no promise")
{
    for (const std::size_t hops : {1, 2, 3})
        walk(100'000, [hops](Dice& dice) { return ChainWalk(dice, hops); });
}

}  // namespace hive::event
