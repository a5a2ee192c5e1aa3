#include <busbar/harness/fault.hpp>

#include "message_fields.hpp"

namespace busbar::harness {

namespace {

Fault make(Fault::Kind kind)
{
    Fault made;
    made.kind = kind;
    return made;
}

} // namespace

Fault Fault::on(Moment when, const Message& what) const
{
    Fault copy = *this;
    copy.moment = when;
    copy.message = what;
    return copy;
}

Fault Fault::at_byte(std::uint64_t offset) const
{
    Fault copy = *this;
    copy.byte_offset = offset;
    return copy;
}

Fault Fault::after(Duration delay) const
{
    Fault copy = *this;
    copy.time = delay;
    return copy;
}

Fault Fault::on_connection(std::size_t number) const
{
    Fault copy = *this;
    copy.connection = number;
    return copy;
}

Fault Fault::sent_by(Side sender) const
{
    Fault copy = *this;
    copy.side = sender;
    return copy;
}

Fault Fault::times(std::size_t number) const
{
    Fault copy = *this;
    copy.count = number;
    return copy;
}

namespace fault {

Fault cut()
{
    return make(Fault::Kind::Cut);
}

Fault delay(Duration by)
{
    Fault made = make(Fault::Kind::Delay);
    made.duration = by;
    return made;
}

Fault hold(Duration time)
{
    Fault made = make(Fault::Kind::Hold);
    made.duration = time;
    return made;
}

Fault half_open()
{
    return make(Fault::Kind::HalfOpen);
}

Fault corrupt(std::size_t position, unsigned bit)
{
    Fault made = make(Fault::Kind::Corrupt);
    made.position = position;
    made.bit = bit % 8;
    return made;
}

Fault split(std::size_t size)
{
    Fault made = make(Fault::Kind::Split);
    made.position = size;
    return made;
}

Fault answer(StatusCode status)
{
    Fault made = make(Fault::Kind::Answer);
    made.status = status;
    return made;
}

Fault drop()
{
    return make(Fault::Kind::Drop);
}

Fault duplicate()
{
    return make(Fault::Kind::Duplicate);
}

Fault overtake()
{
    return make(Fault::Kind::Overtake);
}

Fault change(Fault::Edit edit, std::string text)
{
    Fault made = make(Fault::Kind::Change);
    made.edit = std::move(edit);
    made.edit_text = std::move(text);
    return made;
}

Fault edit(std::string path, std::string text)
{
    std::string what = "edit " + path + " = " + text;
    return change(
        [path = std::move(path), text = std::move(text)](std::vector<std::byte>& body) {
            return detail::edit_message(body, path, text);
        },
        std::move(what));
}

Fault truncate(std::size_t bytes)
{
    return change(
        [bytes](std::vector<std::byte>& body) -> std::string {
            if (bytes > body.size()) {
                return "it has only " + std::to_string(body.size()) + " bytes";
            }
            body.resize(body.size() - bytes);
            return {};
        },
        "truncate " + std::to_string(bytes));
}

Fault jump_clock(Duration by)
{
    Fault made = make(Fault::Kind::JumpClock);
    made.duration = by;
    return made;
}

Fault refuse()
{
    return make(Fault::Kind::Refuse);
}

} // namespace fault

} // namespace busbar::harness
