#include <busbar/controller/program_text.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/text.hpp>

#include "controller/program/cell_table.hpp"
#include "controller/program/program_problem.hpp"
#include "foreign_format.hpp"
#include "plcopen_reader.hpp"
#include "program_bundle.hpp"

namespace busbar::controller {

namespace {

using detail::BundleEntry;

/// Reads the files of a program, which outlive its parts.
class TextReader {
public:
    TextReader(const DeclarationLimits& limits, Unserved unserved, TextEncoding encoding)
        : limits_{&limits}, unserved_{unserved}, encoding_{encoding}
    {
    }

    Configured<Program> read(std::string_view text, std::string_view file_name)
    {
        if (text.size() > limits_->max_text_size) {
            return misconfigured(std::string{file_name},
                                 "is larger than " + std::to_string(limits_->max_text_size) +
                                     " bytes");
        }
        auto added = detail::is_bundle(text) ? add_bundle(text, file_name) : add(text, file_name);
        return std::move(added)
            .and_then([&] { return detail::read_parts(parts_, *limits_, unserved_); })
            .transform([&](Program program) {
                program.encoding = taken_;
                return program;
            });
    }

private:
    Configured<void> add_bundle(std::string_view text, std::string_view file_name)
    {
        const auto entries = detail::read_bundle(text, file_name);
        if (!entries) {
            return Unexpected{entries.error()};
        }
        for (const BundleEntry& each : *entries) {
            parts_.files.emplace_back(each.name);
        }
        for (std::size_t i = 0; i < entries->size(); ++i) {
            const BundleEntry& each = (*entries)[i];
            const auto index = static_cast<std::uint32_t>(i + 1);
            auto added = each.kind == BundleEntry::Kind::File
                             ? add(each.text, parts_.files[i], index)
                             : misconfigured(printable(each.name), printable(each.text));
            if (!added && !leave_out(index, added.error())) {
                return added;
            }
        }
        return {};
    }

    /// Notes a file that cannot be read; false if the program is refused then.
    bool leave_out(std::uint32_t index, const Problem& problem)
    {
        LeftOut one;
        // The reason is often the same for several files, which the name tells apart.
        one.declared.name = parts_.files[index - 1];
        one.declared.place.file = index;
        one.problem = problem;
        parts_.left_out.push_back(std::move(one));
        return unserved_ == Unserved::LeaveOut;
    }

    static Configured<void> check_format(std::string_view bytes, std::string_view file_name)
    {
        const std::string found = detail::foreign_format(bytes);
        if (found.empty()) {
            return {};
        }
        return misconfigured(
            detail::place_text(file_name, {.line = 1, .column = 1}),
            "found " + found +
                "; expected declarations (IEC 61131-3), PLCopen XML, IEC 61131-10, an object of "
                "TwinCAT, a list of labels of GX Works or a table of Sysmac Studio");
    }

    Configured<void> add(std::string_view bytes, std::string_view file_name,
                         std::uint32_t index = 0)
    {
        if (auto known = check_format(bytes, file_name); !known) {
            return known;
        }
        auto decoded = decode_text(bytes, file_name, limits_->max_text_size, encoding_);
        if (!decoded) {
            return Unexpected{std::move(decoded).error()};
        }
        if (auto known = check_format(decoded->text(), file_name); !known) {
            return known;
        }
        if (taken_ == TextEncoding::Utf8) {
            taken_ = decoded->encoding();
        }
        texts_.push_back(std::make_unique<const DecodedText>(*std::move(decoded)));
        sources_.push_back(
            std::make_unique<const detail::SourceText>(texts_.back()->text(), file_name, index));
        return add_source(*sources_.back());
    }

    Configured<void> add_source(const detail::SourceText& source)
    {
        const std::string_view root = detail::xml_root(source.text);
        if (root == "TcPlcObject") {
            return detail::add_twincat(source, *limits_, parts_);
        }
        if (root.empty() && detail::is_sysmac_table(source.text)) {
            return detail::add_sysmac_table(source, parts_);
        }
        if (root.empty() && detail::is_gx_table(source.text)) {
            return detail::add_gx_table(source, parts_);
        }
        if (!root.empty() || source.file.ends_with(".xml")) {
            return detail::add_plcopen(source, *limits_, parts_);
        }
        detail::add_declarations(source, {.text = source.text}, parts_);
        return {};
    }

    const DeclarationLimits* limits_;
    Unserved unserved_;
    TextEncoding encoding_;
    /// The encoding of the first file that is not UTF-8.
    TextEncoding taken_{TextEncoding::Utf8};
    std::vector<std::unique_ptr<const DecodedText>> texts_{};
    std::vector<std::unique_ptr<const detail::SourceText>> sources_{};
    detail::ProgramParts parts_{};
};

} // namespace

Configured<Program> read_program_text(std::string_view text, std::string_view file_name,
                                      const DeclarationLimits& limits, Unserved unserved,
                                      TextEncoding encoding)
{
    return TextReader{limits, unserved, encoding}.read(text, file_name);
}

TextEncoding program_encoding(std::string_view text, TextEncoding encoding)
{
    const auto of = [&](std::string_view bytes) {
        const auto decoded = decode_text(bytes, {}, bytes.size() * 3, encoding);
        return decoded && detail::foreign_format(bytes).empty() &&
                       detail::foreign_format(decoded->text()).empty()
                   ? decoded->encoding()
                   : TextEncoding::Recognized;
    };
    if (!detail::is_bundle(text)) {
        return of(text);
    }
    const auto entries = detail::read_bundle(text, {});
    for (const BundleEntry& each : entries ? *entries : std::vector<BundleEntry>{}) {
        const TextEncoding found =
            each.kind == BundleEntry::Kind::File ? of(each.text) : TextEncoding::Utf8;
        // A file that cannot be read does not count.
        if (found != TextEncoding::Utf8 && found != TextEncoding::Recognized) {
            return found;
        }
    }
    return TextEncoding::Utf8;
}

} // namespace busbar::controller
