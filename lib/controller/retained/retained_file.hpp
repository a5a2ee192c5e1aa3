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
    /// Returns the file.
    [[nodiscard]] std::vector<std::byte> take();

private:
    binary::VectorSink sink_;
    binary::Writer writer_;
};

class RetainedReader {
public:
    /// `file` must outlive this object and the values that it returns.
    explicit RetainedReader(std::span<const std::byte> file);

    /// Tells why the file cannot be read; empty if it can.
    [[nodiscard]] const std::string& problem() const { return problem_; }
    /// Number of the last write in the file; 0 if there is none or the file cannot be read.
    [[nodiscard]] std::uint64_t last_write() const { return last_write_; }
    /// Returns the next value; nothing after the last one.
    [[nodiscard]] std::optional<RetainedValue> next();

private:
    binary::Reader reader_;
    std::uint32_t left_{0};
    std::uint64_t last_write_{0};
    std::string problem_;
};

} // namespace busbar::controller::detail
