// An output with plain receivers and groups through random steps; in the end everybody is there and deals with
// everything.
#include "random_steps.hpp"

namespace hive::event {
namespace {

using namespace random;

class TableWalk {
public:
    explicit TableWalk(Dice& dice) : dice_(dice), table_("camera.image", 1) {}

    void step()
    {
        const auto kind = dice_.between(1, 1000);
        if (kind <= 350)
            offer();
        else if (kind <= 900 && !seats_.empty())
            kind <= 650 ? ask(*dice_.one_of(seats_)) : write(dice_.one_of(seats_)->first);
        else if (kind <= 940 && seats_.size() < 8)
            join();
        else if (kind <= 960 && !seats_.empty())
            go();
        else if (kind <= 990)
            pass(std::chrono::milliseconds(dice_.between(1, 3000)));
        else if (kind <= 995)
            forget("face-" + std::to_string(dice_.between(1, 5)));
        else
            table_.release_held();
        if (++steps_ % 5000 == 0)
            come_to_rest();
    }

    void check() const
    {
        std::size_t away = 0;
        for (const auto& [id, status] : table_.rows()) {
            hold(balanced(status.events), "every ledger balances");
            hold(status.waiting >= 0 && status.waiting <= status.events.in_flight() + (status.group ? 99 : 0),
                 "what waits is in flight");
            hold(id == 0 || seats_.contains(id), "who is gone has no row as one that is there");
            away += !status.connected && !status.group ? 1 : 0;
        }
        hold(away <= ReceiverTable::max_gone + places_.size(), "who was lost is forgotten in the end");
        hold(!table_.demand().asked || table_.demand().wanted, "an output is asked for events only if it is wanted");
        for (const auto& [id, seat] : seats_)
            if (seat.options.group.empty())
                hold(table_.standing({.receiver = seat.name, .place = seat.place}) == id, "each place has one holder");
    }

private:
    struct Seat {
        std::string name;
        std::int64_t registration = 0, place = 0, sent = 0;
        ConnectionOptions options;
        Progress known;
        Lane lane;
        std::int64_t last = 0;  ///< sequence sent, of a plain receiver
    };

    void offer()
    {
        const auto event = any_emission(dice_, ++sequence_, dice_.yes(50));
        for (const char* group : {"workers", "others"})
            if (event->serves(Delivery::data) && (!event->lossless() || has_member(group)))
                lossless_[group] = event->lossless();
        decide([&](Decisions& to) { table_.offer(event, dice_.yes(50), now_, to); });
    }

    void join()
    {
        ConnectionOptions options = window(static_cast<int>(dice_.between(1, 4)));
        if (dice_.yes(50)) {
            options.group = dice_.yes(50) ? "workers" : "others";
            options.lease = std::chrono::milliseconds(500);
        } else if (dice_.yes(30)) {
            options = streaming(dice_.yes(50) ? Delivery::data : Delivery::notification);
        }
        Newcomer newcomer{.id = ++last_id_,
                          .receiver = "face-" + std::to_string(dice_.between(1, 5)),
                          .epoch = 1000 + static_cast<std::int64_t>(last_id_),
                          .options = options};
        if (!places_.empty() && dice_.yes(50))
            come_back(newcomer);
        forget_lost(newcomer.receiver);
        const auto others =
            std::ranges::count_if(seats_, [&](const auto& row) { return row.second.name == newcomer.receiver; });
        const bool kept = newcomer.place != 0 || std::ranges::any_of(places_, [&](const auto& row) {
                              return row.second.name == newcomer.receiver;
                          });
        newcomer.unique = others == 0 || (others == 1 && !kept && dice_.yes(20));
        Seat& seat = seats_[last_id_];
        seat = {.name = newcomer.receiver,
                .registration = newcomer.epoch,
                .options = newcomer.options,
                .known = {},
                .lane = {}};
        if (newcomer.unique)
            inherited_[newcomer.receiver] = sequence_;
        decide([&](Decisions& to) {
            const auto welcome = table_.add(newcomer, now_, to);
            seat.place = welcome.place;
            seat.sent = welcome.taken;
            seat.known = {welcome.taken + newcomer.options.window, welcome.taken, welcome.taken};
            hold(welcome.place != 0, "every receiver has a place");
            hold(newcomer.options.group.empty() != welcome.group.has_value(),
                 "a member gets the progress of its group");
        });
        replace_earlier(newcomer, seat.place);
    }
    /// Who is back before its end was noticed stands alone; that end is then noticed, and means nothing.
    void replace_earlier(const Newcomer& newcomer, std::int64_t place)
    {
        const auto earlier = std::ranges::find_if(seats_, [&](const auto& row) {
            const auto& [id, seat] = row;
            return id != newcomer.id
                   && ((place != 0 && seat.place == place) || (newcomer.unique && seat.name == newcomer.receiver));
        });
        if (earlier == seats_.end())
            return;
        const auto gone = earlier->first;
        seats_.erase(earlier);
        decide([&](Decisions& to) { table_.lose(gone, Fate::lost_cut_off, true, now_, to); });
    }
    void come_back(Newcomer& newcomer)
    {
        const auto place = dice_.one_of(places_);
        newcomer.place = place->second.place;
        newcomer.receiver = place->second.name;
        if (newcomer.options.group != place->second.options.group)
            newcomer.options = place->second.options;
        newcomer.taken = dice_.between(place->second.known.done, place->second.sent);
        places_.erase(place);
    }

    void ask(std::pair<const ReceiverId, Seat>& row)
    {
        auto& [id, seat] = row;
        const auto told = any_progress(dice_, seat.known, seat.sent, seat.options.window);
        tell(id, seat, told,
             dice_.yes(10) ? std::vector{dice_.between(1, seat.sent + 1)} : std::vector<std::int64_t>{});
    }
    void tell(ReceiverId id, Seat& seat, const Progress& told, const std::vector<std::int64_t>& back)
    {
        take_over(seat.known, told, seat.sent, seat.options.window);
        decide([&](Decisions& to) { table_.request(id, seat.registration, told, back, now_, to); });
    }

    void write(ReceiverId id)
    {
        if (Seat& seat = seats_.at(id); !seat.lane.empty()) {
            const auto bytes = seat.lane.written();
            decide([&](Decisions& to) { table_.written(id, bytes, now_, to); });
        }
    }

    void go()
    {
        const auto found = dice_.one_of(seats_);
        const auto [id, seat] = *found;
        seats_.erase(found);
        if (dice_.yes(30)) {
            decide([&, who = id](Decisions& to) { table_.leave(who, now_, to); });
            return check_awaited(seat.options.group);
        }
        std::erase_if(places_, [&](const auto& row) { return row.second.place == seat.place; });
        if (seat.place != 0 && places_.size() < 8)
            places_[id] = seat;
        const bool returns = dice_.yes(90);
        const bool has_twin = std::ranges::any_of(seats_, [&](const auto& row) {
            return row.second.name == seat.name && row.second.options.group == seat.options.group;
        });
        if (returns && !has_twin)
            lost_[seat.options.group][seat.name] = now_;
        decide([&, who = id](Decisions& to) { table_.lose(who, any_loss(dice_), returns, now_, to); });
    }
    void forget(const std::string& drone)
    {
        forget_lost(drone);
        decide([&](Decisions& to) { table_.forget(drone, to); });
    }
    void forget_lost(const std::string& name)
    {
        for (auto& [group, lost] : lost_)
            lost.erase(name);
    }
    [[nodiscard]] bool has_member(const std::string& group) const
    {
        return std::ranges::any_of(seats_, [&](const auto& row) { return row.second.options.group == group; });
    }
    /// A member left. If it was the last one, its group may still wait for others.
    void check_awaited(const std::string& group) const
    {
        const auto lost = lost_.find(group);
        const auto lossless = lossless_.find(group);
        if (group.empty() || has_member(group) || lost == lost_.end()
            || (lossless != lossless_.end() && !lossless->second)
            || std::ranges::none_of(lost->second,
                                    [&](const auto& row) { return row.second + Subscription::kept_for > now_; }))
            return;
        for (const auto& [id, status] : table_.rows())
            hold(status.receiver != "group " + group || status.connected,
                 "a group whose last member left is awaited while one that was lost may return");
    }

    void pass(Clock::duration time)
    {
        now_ += time;
        decide([&](Decisions& to) { table_.tick(now_, to); });
    }

    /// Places expire, each group has a member, and everybody deals with all that comes.
    void come_to_rest()
    {
        places_.clear();
        pass(Subscription::kept_for);
        for (const char* group : {"workers", "others"})
            if (!has_member(group)) {
                ConnectionOptions options = window(2);
                options.group = group;
                Seat& seat = seats_[++last_id_];
                seat = {.name = "last", .registration = 1, .options = options, .known = {2, 0, 0}, .lane = {}};
                decide([&](Decisions& to) {
                    table_.add({.id = last_id_, .receiver = "last", .epoch = 1, .options = options}, now_, to);
                });
            }
        table_.release_held();
        for (int round = 0; table_in_flight() > 0; ++round) {
            hold(round < 20'000, "what is in flight comes to an end when everybody deals with all that comes");
            for (auto& [id, seat] : seats_) {
                while (!seat.lane.empty())
                    write(id);
                tell(id, seat, {seat.sent + seat.options.window, seat.sent, seat.sent}, {});
            }
        }
        hold(!table_.demand().backlogged && table_.demand().asked, "in the end everybody asks for more");
    }
    [[nodiscard]] std::int64_t table_in_flight() const
    {
        std::int64_t sum = 0;
        for (const auto& row : table_.rows())
            sum += row.status.events.in_flight();
        return sum;
    }

    template <class Call>
    void decide(Call call)
    {
        const auto decisions = decided(call);
        for (const auto& send : decisions.sends) {
            hold(seats_.contains(send.receiver), "only who is there is sent something");
            Seat& seat = seats_.at(send.receiver);
            seat.lane.sent(send.event->size());
            ++seat.sent;
            hold(seat.options.transfer == Transfer::streaming || seat.sent <= seat.known.asked,
                 "nobody is sent more than it asked for");
            if (seat.options.group.empty() && sequence_of(send.event) > inherited_[seat.name])
                hold(sequence_of(send.event) > std::exchange(seat.last, sequence_of(send.event)),
                     "a plain receiver gets events in their order, each once");
        }
    }

    Dice& dice_;
    ReceiverTable table_;
    Clock::time_point now_ = start;
    std::map<ReceiverId, Seat> seats_;
    std::map<ReceiverId, Seat> places_;  ///< of those that were lost, as they remember them
    std::map<std::string, std::map<std::string, Clock::time_point>> lost_;  ///< by group, since when
    std::map<std::string, bool> lossless_;  ///< by group: was the last event that was offered? Then others may follow
    std::map<std::string, std::int64_t> inherited_;  ///< what was emitted until then may have been in a group
    ReceiverId last_id_ = 0;
    std::int64_t sequence_ = 0;
    std::uint64_t steps_ = 0;
};

}  // namespace

TEST_CASE("receiver table: a hundred thousand random steps break no promise, and everything comes to an end")
{
    walk(100'000, [](Dice& dice) { return TableWalk(dice); });
}

}  // namespace hive::event
