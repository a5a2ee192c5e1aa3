#pragma once

#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/life_cycle.hpp>
#include <busbar/core/record.hpp>

namespace busbar::test {

using Texts = std::vector<std::string>;

inline const controller::ServerSettings not_used{};

/// Settings that cannot be read.
inline Configured<controller::ServerSettings> damaged()
{
    return misconfigured("server.json", "is cut");
}

/// Keeps what it is told: "ServerHalted Configuration Error".
class RecordKeeper final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view line) override
    {
        lines.emplace_back(line);
    }
    [[nodiscard]] bool wants(RecordKind) const override { return true; }
    void record(const Record& record) override
    {
        std::string entry{name(record.kind)};
        for (const RecordField& each : record.fields) {
            if (const auto* const text = each.value.get_if<String>()) {
                entry += " " + text->str();
            } else if (const auto* const code = each.value.get_if<std::uint16_t>()) {
                entry += " " + std::to_string(*code);
            }
        }
        records.push_back(std::move(entry));
    }
    /// What came since the last call.
    [[nodiscard]] std::vector<std::string> take() { return std::exchange(records, {}); }

    std::vector<std::string> records;
    std::vector<std::string> lines;
};

class SetClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }
    DateTime time{DateTime::from_unix_seconds(1'000'000)};
};

/// A program that does nothing but write down what it is asked for. The test answers.
class ServerStub final : public controller::ServerOperator {
public:
    void initialize() override { calls.emplace_back("initialize"); }
    void prepare(std::uint32_t n, const controller::ServerSettings& settings) override
    {
        number = n;
        calls.push_back("prepare " + std::to_string(settings.port));
    }
    void reconfigure(std::uint32_t n, const controller::ServerSettings& settings,
                     const controller::StopNotice& notice) override
    {
        number = n;
        keep("reconfigure " + std::to_string(settings.port), notice);
    }
    void run() override { calls.emplace_back("run"); }
    void suspend(const controller::StopNotice& notice) override { keep("suspend", notice); }
    void stop(const controller::StopNotice& notice) override { keep("stop", notice); }
    void add_variables() override { calls.emplace_back("add variables"); }
    void medium_changed(bool is_in) override { calls.emplace_back(is_in ? "in" : "out"); }
    void save_now() override { calls.emplace_back("save"); }

    [[nodiscard]] std::vector<std::string> take() { return std::exchange(calls, {}); }

    std::vector<std::string> calls;
    std::uint32_t number{0};
    std::string reason;
    DateTime return_time;

private:
    void keep(std::string call, const controller::StopNotice& notice)
    {
        calls.push_back(std::move(call));
        reason = notice.reason;
        return_time = notice.return_time;
    }
};

inline constexpr const char* life_url = "opc.tcp://192.168.250.1:4840";

/// A controller whose server's life is looked at.
struct LifeFixture {
    [[nodiscard]] static controller::ServerSettings used()
    {
        controller::ServerSettings settings;
        settings.is_used = true;
        return settings;
    }
    void forget()
    {
        log.records.clear();
        server.calls.clear();
    }
    void start(const controller::ServerSettings& settings = used())
    {
        life.power_on();
        life.initialized(settings);
        finish_preparation();
        forget();
    }
    void finish_preparation() { life.prepared(server.number, life_url); }
    [[nodiscard]] std::string status() const
    {
        return std::string{controller::text(life.operating_status())};
    }

    RecordKeeper log;
    SetClock clock;
    ServerStub server;
    controller::LifeCycle life{server, clock, log};
};

} // namespace busbar::test
