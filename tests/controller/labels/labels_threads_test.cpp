#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <span>
#include <thread>

#include "label_bench.hpp"

namespace labels_threads_test {

// A PLC that scans as fast as it can, while a server reads, writes and samples its labels.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

constexpr int values = 16;

std::string elements_of(const std::string& name)
{
    return name + " : ARRAY [0.." + std::to_string(values - 1) + "] OF DINT; ";
}

std::vector<std::string> names_of(const std::string& name)
{
    std::vector<std::string> names;
    for (int i = 0; i < values; ++i) {
        names.push_back(name + "[" + std::to_string(i) + "]");
    }
    return names;
}

Program threads_program()
{
    return program_of(elements_of("FromPlc") + elements_of("ToPlc"));
}

/// Answers on their way from one thread to another.
class Mailbox final : public backend::LabelListener {
public:
    void done(std::unique_ptr<LabelRequest> request) override
    {
        const std::lock_guard lock{mutex_};
        request->next = std::move(newest_);
        newest_ = std::move(request);
    }
    void labels_changed() override { ++changes; }

    [[nodiscard]] std::unique_ptr<LabelRequest> take()
    {
        const std::lock_guard lock{mutex_};
        auto taken = std::move(newest_);
        if (taken != nullptr) {
            newest_ = std::move(taken->next);
        }
        return taken;
    }

    std::atomic<int> changes{0};

private:
    std::mutex mutex_;
    std::unique_ptr<LabelRequest> newest_{};
};

/// The PLC's thread: in each scan all of FromPlc gets one number, and all of ToPlc must have one.
class ScanningPlc {
public:
    explicit ScanningPlc(SimulatedLabels& labels) : labels_{&labels}
    {
        thread_ = std::thread{[this] { run(); }};
    }
    ScanningPlc(const ScanningPlc&) = delete;
    ScanningPlc& operator=(const ScanningPlc&) = delete;
    ~ScanningPlc() { stop(); }

    void stop()
    {
        is_stopping_ = true;
        if (thread_.joinable()) {
            thread_.join();
        }
    }

    std::atomic<std::int32_t> scans{0};
    std::atomic<int> torn_writes{0};

private:
    void run()
    {
        while (!is_stopping_) {
            const std::int32_t scan = ++scans;
            server::ImageMemory& memory = labels_->memory();
            for (std::int32_t& value : memory.values<std::int32_t>(0)) {
                value = scan;
            }
            const auto written = memory.values<std::int32_t>(1);
            for (const std::int32_t value : written) {
                torn_writes += value != written.front() ? 1 : 0;
            }
            labels_->end_of_scan(DateTime{scan});
            std::this_thread::yield(); // a machine may have one processor
        }
        labels_->halt(DateTime{});
    }

    SimulatedLabels* labels_;
    std::atomic<bool> is_stopping_{false};
    std::thread thread_;
};

/// Whether all values of these bytes are the same.
bool is_whole(std::span<const std::byte> bytes)
{
    constexpr std::size_t size = sizeof(std::int32_t);
    for (std::size_t i = size; i < bytes.size(); i += size) {
        if (!std::ranges::equal(bytes.subspan(i, size), bytes.first(size))) {
            return false;
        }
    }
    return true;
}

/// The server's thread.
struct AskingServer {
    explicit AskingServer(SimulatedLabels& asked) : labels{&asked} { labels->attach(&mailbox); }
    AskingServer(const AskingServer&) = delete;
    AskingServer& operator=(const AskingServer&) = delete;
    ~AskingServer() { labels->attach(nullptr); }

    [[nodiscard]] std::unique_ptr<LabelRequest> ask(std::unique_ptr<LabelRequest> request)
    {
        labels->start(std::move(request));
        for (;;) {
            if (auto answer = mailbox.take()) {
                return answer;
            }
            std::this_thread::yield();
        }
    }
    [[nodiscard]] std::unique_ptr<LabelRequest> request(LabelRequest::Kind kind,
                                                        const std::string& name)
    {
        auto names = std::make_unique<LabelRequest>();
        names->kind = LabelRequest::Kind::Resolve;
        names->names = names_of(name);
        return LabelBench::request(kind, ask(std::move(names))->labels);
    }

    SimulatedLabels* labels;
    Mailbox mailbox{};
};

void fill(std::vector<std::byte>& bytes, std::int32_t value)
{
    const auto one = wire(value);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = one[i % one.size()];
    }
}

} // namespace

TEST_CASE("no value is torn between a PLC that scans and a server")
{
    const auto labels = SimulatedLabels::create(threads_program()).value();
    ScanningPlc plc{*labels};
    AskingServer server{*labels};
    auto sample = server.ask(server.request(LabelRequest::Kind::Sample, "FromPlc"));
    REQUIRE(sample->status == LabelStatus::Done);
    auto read = server.request(LabelRequest::Kind::Read, "FromPlc");
    auto write = server.request(LabelRequest::Kind::Write, "ToPlc");
    std::vector<std::byte> sampled(sample->bytes.size());
    constexpr std::int32_t rounds = 100;
    std::uint64_t last_scan = 0;
    int torn = 0;
    int wrong = 0;
    for (std::int32_t i = 0; i < rounds; ++i) {
        read = server.ask(std::move(read));
        wrong += read->status != LabelStatus::Done || read->scans != 1 ? 1 : 0;
        torn += is_whole(read->bytes) ? 0 : 1;
        fill(write->bytes, i);
        write = server.ask(std::move(write));
        wrong += write->status != LabelStatus::Done ? 1 : 0;
        DateTime time{};
        const std::uint64_t scan = labels->sampled(sampled, time);
        torn += is_whole(sampled) ? 0 : 1;
        wrong += scan < last_scan ? 1 : 0;
        last_scan = scan;
    }
    plc.stop();
    CHECK(torn == 0);
    CHECK(wrong == 0);
    CHECK(last_scan != 0);
    CHECK(plc.torn_writes == 0);
    CHECK(labels->memory().value<std::int32_t>(1) == rounds - 1);
}

TEST_CASE("labels change while a PLC scans and a server reads")
{
    const auto labels = SimulatedLabels::create(threads_program()).value();
    ScanningPlc plc{*labels};
    AskingServer server{*labels};
    constexpr int changes = 20;
    std::atomic<bool> is_changed{false};
    std::thread editor{[&] {
        for (int i = 0; i < changes; ++i) {
            static_cast<void>(labels->replace_program(
                read_declarations("{attribute 'publish' := 'public'} VAR_GLOBAL " +
                                      elements_of("FromPlc") + elements_of("ToPlc") +
                                      (i % 2 == 0 ? elements_of("Other") : "") + " END_VAR",
                                  "test")
                    .value()));
        }
        is_changed = true;
    }};
    auto read = server.request(LabelRequest::Kind::Read, "FromPlc");
    int torn = 0;
    int unexpected = 0;
    bool is_last = false;
    do {
        is_last = is_changed; // one more read afterwards
        read = server.ask(std::move(read));
        if (read->status == LabelStatus::Mismatch) {
            read = server.request(LabelRequest::Kind::Read, "FromPlc");
            continue;
        }
        unexpected += read->status != LabelStatus::Done ? 1 : 0;
        torn += is_whole(read->bytes) ? 0 : 1;
    } while (!is_last || read->status != LabelStatus::Done);
    editor.join();
    CHECK(torn == 0);
    CHECK(unexpected == 0);
    CHECK(server.mailbox.changes == changes);
}

TEST_CASE("a listener can be taken away while a PLC answers")
{
    const auto labels = SimulatedLabels::create(threads_program()).value();
    ScanningPlc plc{*labels};
    int answered = 0;
    for (int i = 0; i < 50; ++i) {
        AskingServer server{*labels};
        auto read = server.request(LabelRequest::Kind::Read, "FromPlc");
        answered += read->places.size() == values ? 1 : 0;
        labels->start(std::move(read));
    }
    CHECK(answered == 50);
}

} // namespace labels_threads_test
