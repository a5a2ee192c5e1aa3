#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/simulated_labels.hpp>

namespace busbar::controller::test {

using backend::LabelError;
using backend::LabelKind;
using backend::LabelRequest;
using backend::LabelStatus;
using backend::LabelType;
using backend::ResolvedLabel;
using backend::TimerPart;

/// Global variables as their declarations, all published, and types before them.
[[nodiscard]] inline Program program_of(const std::string& variables, const std::string& types = "")
{
    auto program = read_declarations(
        types + "{attribute 'publish' := 'public'} VAR_GLOBAL " + variables + " END_VAR", "test");
    INFO((program ? "" : text(program.error())));
    REQUIRE(program);
    return std::move(*program);
}

/// Keeps what comes, as it may be told at any moment of a scan.
class AnswerBook final : public backend::LabelListener {
public:
    AnswerBook() { answers.reserve(room); }

    void done(std::unique_ptr<LabelRequest> request) override
    {
        answers.push_back(std::move(request));
    }
    void labels_changed() override { ++changes; }

    static constexpr std::size_t room = 256;
    std::vector<std::unique_ptr<LabelRequest>> answers{};
    int changes{0};
};

/// A number as it is in the bytes of a request.
template <typename T>
[[nodiscard]] std::vector<std::byte> wire(T value)
{
    std::vector<std::byte> bytes(sizeof value);
    std::uint64_t bits = 0;
    if constexpr (std::is_floating_point_v<T>) {
        std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t> same{};
        std::memcpy(&same, &value, sizeof value);
        bits = same;
    } else {
        bits = static_cast<std::uint64_t>(value);
    }
    for (std::byte& byte : bytes) {
        byte = static_cast<std::byte>(bits & 0xFFU);
        bits >>= 8U;
    }
    return bytes;
}

[[nodiscard]] inline std::vector<std::byte> wire(std::string_view text)
{
    const auto bytes = std::as_bytes(std::span{text});
    return {bytes.begin(), bytes.end()};
}

/// A PLC with labels in virtual time, and who asks for them.
class LabelBench {
public:
    explicit LabelBench(Program program, const SimulatedLabelsOptions& options = {})
    {
        auto made = SimulatedLabels::create(std::move(program), options);
        INFO((made ? "" : text(made.error())));
        REQUIRE(made);
        labels = std::move(*made);
        labels->attach(&book);
    }

    void scan() { labels->end_of_scan(DateTime{++scans}); }

    /// The oldest answer that nobody has looked at; null if there is none.
    [[nodiscard]] std::unique_ptr<LabelRequest> answer()
    {
        if (book.answers.empty()) {
            return nullptr;
        }
        auto oldest = std::move(book.answers.front());
        book.answers.erase(book.answers.begin());
        return oldest;
    }
    /// Lets the next scan answer it.
    [[nodiscard]] std::unique_ptr<LabelRequest> serve(std::unique_ptr<LabelRequest> request)
    {
        labels->start(std::move(request));
        scan();
        return answer();
    }

    [[nodiscard]] std::vector<ResolvedLabel> resolve(const std::vector<std::string>& names)
    {
        auto request = std::make_unique<LabelRequest>();
        request->kind = LabelRequest::Kind::Resolve;
        request->names = names;
        return serve(std::move(request))->labels;
    }
    [[nodiscard]] ResolvedLabel resolve(const std::string& name)
    {
        return resolve(std::vector{name}).front();
    }

    /// Of labels that are resolved now, one behind another.
    [[nodiscard]] std::unique_ptr<LabelRequest> request(LabelRequest::Kind kind,
                                                        const std::vector<std::string>& names)
    {
        return request(kind, resolve(names));
    }
    [[nodiscard]] static std::unique_ptr<LabelRequest>
    request(LabelRequest::Kind kind, const std::vector<ResolvedLabel>& labels)
    {
        auto request = std::make_unique<LabelRequest>();
        request->kind = kind;
        std::size_t end = 0;
        for (const ResolvedLabel& label : labels) {
            const std::size_t size = backend::size_of(label.kind);
            request->places.push_back(
                {label.address, static_cast<std::uint32_t>(end), static_cast<std::uint32_t>(size)});
            end += size;
        }
        request->bytes.resize(end);
        return request;
    }
    [[nodiscard]] std::unique_ptr<LabelRequest> to_read(const std::vector<std::string>& names)
    {
        return request(LabelRequest::Kind::Read, names);
    }
    [[nodiscard]] std::unique_ptr<LabelRequest> to_sample(const std::vector<std::string>& names)
    {
        return request(LabelRequest::Kind::Sample, names);
    }
    [[nodiscard]] std::unique_ptr<LabelRequest> to_write(const std::vector<std::string>& names,
                                                         std::vector<std::byte> bytes)
    {
        auto made = request(LabelRequest::Kind::Write, names);
        made->bytes = std::move(bytes);
        return made;
    }

    [[nodiscard]] std::vector<std::byte> read(const std::string& name)
    {
        return serve(to_read({name}))->bytes;
    }
    LabelStatus write(const std::string& name, std::vector<std::byte> bytes)
    {
        return serve(to_write({name}, std::move(bytes)))->status;
    }
    LabelStatus sample(const std::vector<std::string>& names)
    {
        return serve(to_sample(names))->status;
    }

    /// A variable in the PLC's memory.
    template <typename T>
    [[nodiscard]] T& variable(std::string_view name)
    {
        const auto program = labels->program();
        return labels->memory().value<T>(program->handle_of(*program->variable(name)).value());
    }

    AnswerBook book{};
    std::unique_ptr<SimulatedLabels> labels{};
    std::int64_t scans{0};
};

} // namespace busbar::controller::test
