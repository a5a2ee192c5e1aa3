#include "mutated.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/writer.hpp>

#include "administration_calls.hpp"
#include "load.hpp"
#include "own_server.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

using Bytes = std::vector<std::byte>;

/// A sanitizer's controller is slow.
constexpr std::chrono::milliseconds mutated_patience{30'000};
/// Between two that are answered.
constexpr std::chrono::seconds longest_silence{180};
/// Under way at a time.
constexpr std::size_t together = 24;

/// Changes bytes at random places.
class Mutator {
public:
    explicit Mutator(unsigned seed) : engine_{seed} {}

    /// 0 to `sides` - 1.
    [[nodiscard]] std::size_t roll(std::size_t sides)
    {
        return std::uniform_int_distribution<std::size_t>{0, sides - 1}(engine_);
    }
    /// Makes one or two changes; `other` is what a part may be replaced by.
    void change(Bytes& bytes, const Bytes& other)
    {
        for (std::size_t left = 1 + roll(2); left > 0; --left) {
            if (bytes.empty()) {
                bytes.push_back(any());
            }
            change_once(bytes, other);
        }
    }

private:
    [[nodiscard]] std::byte any() { return static_cast<std::byte>(roll(256)); }
    void change_once(Bytes& bytes, const Bytes& other)
    {
        const std::size_t at = roll(bytes.size());
        const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const std::size_t size = 1 + roll(std::min<std::size_t>(bytes.size() - at, 32));
        const auto end = place + static_cast<std::ptrdiff_t>(size);
        switch (roll(8)) {
        case 0:
            *place ^= static_cast<std::byte>(1U << roll(8));
            break;
        case 1:
            *place = any();
            break;
        case 2:
            set_number(bytes, at);
            break;
        case 3:
            bytes.erase(place, end);
            break;
        case 4: {
            const Bytes copy(place, end);
            bytes.insert(place, copy.begin(), copy.end());
            break;
        }
        case 5:
            bytes.insert(place, size, any());
            break;
        case 6:
            bytes.resize(at);
            break;
        default:
            bytes.resize(at);
            bytes.insert(bytes.end(),
                         other.begin() + static_cast<std::ptrdiff_t>(std::min(at, other.size())),
                         other.end());
        }
    }
    /// A length or a count, as a hostile client would have it.
    void set_number(Bytes& bytes, std::size_t at)
    {
        static constexpr std::array<std::uint32_t, 8> numbers{
            0, 1, 0xFF, 0xFFFF, 0x7FFF'FFFF, 0x8000'0000, 0xFFFF'FFFE, 0xFFFF'FFFF};
        const std::uint32_t number = numbers[roll(numbers.size())];
        for (std::size_t i = 0; i < sizeof number && at + i < bytes.size(); ++i) {
            bytes[at + i] = static_cast<std::byte>(number >> (8 * i) & 0xFFU);
        }
    }

    std::mt19937 engine_;
};

/// How many are left to be sent, for all roles.
struct Supply {
    explicit Supply(std::size_t requests) : left{requests} {}

    [[nodiscard]] bool is_over() const { return has_ended || left == 0; }
    /// How many of `most` may be sent.
    [[nodiscard]] std::size_t take(std::size_t most)
    {
        std::size_t before = left;
        while (!left.compare_exchange_weak(before, before - std::min(before, most))) {
        }
        return std::min(before, most);
    }

    std::atomic<std::size_t> left;
    std::atomic<std::size_t> answered{0};
    std::atomic<bool> has_ended{false};
};

Options options_of(const OwnController& controller, std::string_view role)
{
    Options options;
    options.url = controller.url();
    options.policy = "Basic256Sha256";
    options.mode = "SignAndEncrypt";
    options.user = role;
    options.password = good_password;
    options.identity = controller.client();
    return options;
}

Bytes parameters_of(const CallRequest& request)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.length(request.methods_to_call.size());
    for (const CallMethodRequest& each : request.methods_to_call) {
        encode(writer, each);
    }
    return sink.take(writer.written());
}

/// A user with one of the roles, who comes again when the connection ends.
class MutatingUser {
public:
    MutatingUser(const OwnController& controller, std::string_view role, Supply& supply,
                 unsigned seed)
        : supply_{supply}, mutator_{seed}, load_{options_of(controller, role)}
    {
        row_.what = role;
    }

    void run()
    {
        while (!supply_.is_over()) {
            net::ClientLoop loop;
            if (load_.prepare() && load_.open(loop, true, mutated_patience)) {
                stay(loop);
            } else {
                std::this_thread::sleep_for(200ms);
            }
        }
    }
    [[nodiscard]] const ChurnRow& row() const { return row_; }

private:
    void stay(net::ClientLoop& loop)
    {
        if (methods_.empty()) {
            auto found = find_methods(loop);
            methods_ = found ? *std::move(found) : std::vector<AdministrationMethod>{};
        }
        while (!methods_.empty() && !supply_.is_over()) {
            if (!calls_.call(loop, any(), 1) || !send_some(loop)) {
                return;
            }
        }
        loop.close();
    }
    [[nodiscard]] const AdministrationMethod& any()
    {
        return methods_[mutator_.roll(methods_.size())];
    }
    /// False if the connection has ended.
    [[nodiscard]] bool send_some(net::ClientLoop& loop)
    {
        const std::size_t count = supply_.take(together);
        std::size_t open = 0;
        for (std::size_t i = 0; i < count; ++i) {
            Bytes bytes = parameters_of(calls_.request(any(), 1 + mutator_.roll(3)));
            mutator_.change(bytes, parameters_of(calls_.request(any(), 1)));
            open += send(loop, bytes) ? 1U : 0U;
        }
        row_.refused += count - open;
        for (; open > 0; --open) {
            const auto event = loop.wait(mutated_patience);
            if (!event || event->kind != client::ConnectionEvent::Kind::Response) {
                row_.refused += open;
                return false;
            }
            ++supply_.answered;
            ++(event->status.is_good() ? row_.good : row_.refused);
        }
        return true;
    }
    [[nodiscard]] static bool send(net::ClientLoop& loop, const Bytes& parameters)
    {
        return loop.client()
            .send_encoded([&](binary::Writer& writer, const RequestHeader& header) {
                encode(writer, NodeId{0, CallRequest::binary_encoding_id});
                encode(writer, header);
                writer.bytes(parameters);
            })
            .has_value();
    }

    Supply& supply_;
    Mutator mutator_;
    Load load_;
    std::vector<AdministrationMethod> methods_;
    AdministrationCalls calls_;
    ChurnRow row_;
};

/// Until all is sent, or the controller has ended or is silent.
void watch(OwnController& controller, Supply& supply)
{
    TimePoint latest = clock_now();
    std::size_t answered = 0;
    while (!supply.is_over()) {
        std::this_thread::sleep_for(50ms);
        if (supply.answered != answered) {
            answered = supply.answered;
            latest = clock_now();
        }
        supply.has_ended = !controller.is_running() || clock_now() - latest > longest_silence;
    }
}

} // namespace

std::vector<ChurnRow> send_mutated(OwnController& controller, std::size_t requests, unsigned seed)
{
    Supply supply{requests};
    std::vector<std::unique_ptr<MutatingUser>> users;
    for (const std::string_view role : administration_roles) {
        const auto number = static_cast<unsigned>(users.size());
        users.push_back(
            std::make_unique<MutatingUser>(controller, role, supply, seed * 1'000 + number));
    }
    std::vector<std::thread> threads;
    threads.reserve(users.size());
    for (const auto& user : users) {
        threads.emplace_back([&user] { user->run(); });
    }
    watch(controller, supply);
    std::vector<ChurnRow> rows;
    for (std::size_t i = 0; i < users.size(); ++i) {
        threads[i].join();
        rows.push_back(users[i]->row());
    }
    return rows;
}

} // namespace busbar::bench
