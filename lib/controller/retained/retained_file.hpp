#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>

namespace busbar::controller::detail {

// FORMAT.md describes the file of retained values and the journal.

struct RetainedValue {
    std::string_view name;
    std::uint64_t type_print;
    std::span<const std::byte> bytes;
};

class RetainedWriter {
public:
    RetainedWriter(std::size_t count, std::uint64_t last_write);
    void add(const RetainedValue& value);
    /// The file.
    [[nodiscard]] std::vector<std::byte> take();

private:
    binary::VectorSink sink_;
    binary::Writer writer_;
};

class RetainedReader {
public:
    /// `file` must outlive it and what it gives.
    explicit RetainedReader(std::span<const std::byte> file);

    /// Empty: it can be read to its end. Else why not.
    [[nodiscard]] const std::string& problem() const { return problem_; }
    /// 0 if there is a problem, or none was written yet.
    [[nodiscard]] std::uint64_t last_write() const { return last_write_; }
    /// None behind the last.
    [[nodiscard]] std::optional<RetainedValue> next();

private:
    binary::Reader reader_;
    std::uint32_t left_{0};
    std::uint64_t last_write_{0};
    std::string problem_;
};

} // namespace busbar::controller::detail
