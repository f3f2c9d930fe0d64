// A plain receiver through random steps, beside simple books of what must have become of each event.
#include "random_steps.hpp"

namespace hive::event {
namespace {

using namespace random;

class LineWalk {
public:
    explicit LineWalk(Dice& dice) : dice_(dice) { begin_anew(); }

    void step()
    {
        const auto kind = dice_.between(1, 100);
        if (kind <= 40)
            offer();
        else if (kind <= 65)
            ask();
        else if (kind <= 92)
            write();
        else if (!line_->kept() && kind <= 96)
            lose();
        else if (line_->kept())
            kind <= 99 ? resume() : expire();
        else if (kind == 97)
            leave();
    }

    void check() const
    {
        const auto in_hand = std::ssize(in_hand_), waiting = std::ssize(waiting_);
        hold(balanced(ledger_), "the ledger balances");
        hold(ledger_ == books_, "each event has the fate that it must have");
        hold(line_->waiting() == waiting, "what waits is what waits");
        hold(ledger_.in_flight() == waiting + in_hand, "in flight is what waits and what is in hand");
        hold(line_->backlogged() == (waiting > 0 && waiting_.front().event->lossless()), "backlog is what must not go");
        if (!line_->kept() && waiting > 0)
            hold(!open(waiting_.front()) || !lane_.free(waiting_.front().event->size()), "nothing stands still");
    }

private:
    struct Item {
        EmissionPtr event;
        int attempts = 0, failures = 0;
    };

    void begin_anew()
    {
        options_ = dice_.yes(30) ? streaming() : window(static_cast<int>(dice_.between(1, 5)));
        line_.emplace(1, "face", ++registration_, options_, ledger_);
        sent_ = 0;
        known_ = {.asked = options_.window, .worked = 0, .done = 0};
        lane_ = {};
        last_was_lossless_ = true;
    }

    void offer()
    {
        const bool lossless = dice_.yes(60);
        const auto event = any_emission(dice_, ++sequence_, lossless);
        last_was_lossless_ = lossless;
        if (!line_->kept())
            now_ += std::chrono::milliseconds(dice_.between(0, 100));
        if (!line_->kept() || lossless) {
            books_.came();
            const bool replaces = options_.transfer == Transfer::synchronized && !lossless && !waiting_.empty()
                                  && !waiting_.back().event->lossless();
            if (replaces) {
                waiting_.pop_back();
                books_.went(Fate::skipped);
            }
            if (waiting_.empty())
                behind_since_ = now_;
            waiting_.push_back({event});
        }
        decide([&](Decisions& to) { line_->offer(event, now_, to); });
        if (options_.transfer == Transfer::streaming)
            drop_oldest();
    }

    void drop_oldest()
    {
        std::size_t bytes = 0;
        for (const auto& item : waiting_)
            bytes += item.event->size();
        const auto over = [&] {
            return waiting_.size() > Line::most_queued_events
                   || (waiting_.size() > 1 && bytes > Line::most_queued_bytes)
                   || (now_ - behind_since_ >= Line::most_behind && waiting_.size() > 2 && bytes > Credit::lane_bytes);
        };
        const auto live = [](const auto& item) { return !item.event->lossless(); };
        for (auto oldest = std::ranges::find_if(waiting_, live); over() && oldest != waiting_.end();
             oldest = std::ranges::find_if(waiting_, live)) {
            bytes -= oldest->event->size();
            books_.went(Fate::dropped);
            waiting_.erase(oldest);
        }
    }

    void ask()
    {
        const auto told = any_progress(dice_, known_, sent_, options_.window);
        const bool stale = dice_.yes(3);
        if (!line_->kept() && !stale) {
            take_over(known_, told, sent_, options_.window);
            while (sent_ - std::ssize(in_hand_) < known_.done) {
                end(in_hand_.front());
                in_hand_.pop_front();
                books_.went(Fate::acknowledged);
            }
        }
        if (!line_->kept())
            decide([&](Decisions& to) { line_->request(stale ? registration_ - 1 : registration_, told, to); });
    }

    void write()
    {
        if (!line_->kept() && !lane_.empty()) {
            const auto bytes = lane_.written();
            decide([&](Decisions& to) { line_->written(bytes, to); });
        }
    }

    void lose()
    {
        const auto how = any_loss(dice_);
        const bool keep = dice_.yes(90);
        const auto lossless = [](const Item& item) { return item.event->lossless(); };
        const bool kept = keep
                          && (last_was_lossless_ || (!waiting_.empty() && lossless(waiting_.front()))
                              || std::ranges::any_of(in_hand_, lossless));
        lost_as_ = how;
        const auto head = known_.worked - known_.done;
        if (kept && how != Fate::lost_connection && head < std::ssize(in_hand_))
            ++in_hand_[static_cast<std::size_t>(head)].failures;
        if (kept)
            books_.went(how, static_cast<std::int64_t>(
                                 std::erase_if(waiting_, [&](const Item& item) { return !lossless(item); })));
        hold(line_->lose(how, keep, now_) == kept, "a place is kept where the source waits for its receivers");
        lane_ = {};
        if (!kept)
            all_gone(how);
    }

    void resume()
    {
        now_ += std::chrono::seconds(dice_.between(0, 29));
        hold(!line_->overdue(now_), "a place is kept for 30 s");
        const auto done = known_.done;
        std::optional<std::int64_t> taken;
        if (dice_.yes(50))
            taken = dice_.yes(90) ? dice_.between(done, sent_) : dice_.between(-9, sent_ + 9);
        const auto goes_on = taken ? std::clamp(*taken, done, sent_) : done;
        put_back(goes_on - done);
        if (!taken)
            give_up();
        sent_ = goes_on;
        known_ = {.asked = goes_on + options_.window, .worked = std::min(known_.worked, goes_on), .done = done};
        decide([&](Decisions& to) {
            hold(line_->resume(1, ++registration_, options_, taken, to) == goes_on, "it goes on behind what it has");
            line_->pump(to);
        });
    }

    void put_back(std::int64_t stay)
    {
        for (; std::ssize(in_hand_) > stay; in_hand_.pop_back())
            if (in_hand_.back().event->lossless())
                waiting_.push_front(in_hand_.back());
            else
                books_.went(lost_as_);
    }

    void give_up()
    {
        std::erase_if(waiting_, [&](const Item& item) {
            const bool over = item.failures >= Line::most_failures;
            if (over) {
                books_.went(Fate::abandoned);
                expected_failures_.push_back(sequence_of(item.event));
            }
            return over;
        });
    }

    void expire()
    {
        now_ += Line::place_kept;
        hold(line_->overdue(now_), "a place is kept for 30 s, not longer");
        line_->expire();
        all_gone(lost_as_);
    }

    void leave()
    {
        line_->clear(Fate::lost_left);
        all_gone(Fate::lost_left);
    }

    void all_gone(Fate how)
    {
        books_.went(how, std::ssize(waiting_) + std::ssize(in_hand_));
        for (const auto* items : {&waiting_, &in_hand_})
            std::ranges::for_each(*items, [&](const Item& item) { end(item); });
        waiting_.clear();
        in_hand_.clear();
        begin_anew();
    }

    void end(const Item& item)
    {
        ends_.resize(static_cast<std::size_t>(sequence_) + 1);
        if (item.event->lossless())
            hold(++ends_[static_cast<std::size_t>(sequence_of(item.event))] == 1, "each lossless event has one end");
    }

    [[nodiscard]] bool open(const Item& item) const
    {
        if (options_.transfer == Transfer::streaming)
            return !item.event->lossless() || sent_ - known_.worked < Credit::most_streamed;
        return sent_ < known_.asked;
    }

    template <class Call>
    void decide(Call call)
    {
        const auto decisions = decided(call);
        for (const auto& event : decisions.failed)
            end({event});
        hold(std::ranges::equal(decisions.failed, std::exchange(expected_failures_, {}), {}, sequence_of),
             "given up is what the receiver died of three times");
        for (const auto& send : decisions.sends)
            sent(send);
    }

    void sent(const Send& send)
    {
        hold(!line_->kept(), "who is away is sent nothing");
        if (options_.transfer == Transfer::streaming && waiting_.size() > 1 && waiting_.front().event != send.event)
            drop_oldest();
        hold(!waiting_.empty() && waiting_.front().event == send.event, "events go out in their order, each once");
        hold(open(waiting_.front()), "nobody is sent more than was asked for");
        Item item = std::move(waiting_.front());
        waiting_.pop_front();
        ++item.attempts;
        hold(send.share.has_value() == (item.attempts > 1), "who gets it first is told what all are told");
        hold(!send.share || send.share->attempt == item.attempts, "it is told how often the event was sent");
        lane_.sent(item.event->size());
        ++sent_;
        in_hand_.push_back(std::move(item));
    }

    Dice& dice_;
    Ledger ledger_, books_;
    ConnectionOptions options_;
    std::optional<Line> line_;
    Clock::time_point now_ = start, behind_since_{};
    std::int64_t registration_ = 100, sequence_ = 0, sent_ = 0;
    Progress known_;
    Lane lane_;
    bool last_was_lossless_ = true;  ///< or may be, as long as there was none
    Fate lost_as_{};
    std::deque<Item> waiting_, in_hand_;
    Sequences expected_failures_;
    std::vector<int> ends_;  ///< by sequence
};

}  // namespace

TEST_CASE("line: a hundred thousand random steps break no promise")
{
    walk(100'000, [](Dice& dice) { return LineWalk(dice); });
}

}  // namespace hive::event
