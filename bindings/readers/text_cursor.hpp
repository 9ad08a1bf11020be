// A place in a text that is read line by line and word by word.
#pragma once

#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "mesh_formats.hpp"

namespace readers {

// A piece of a file for a sentence: short, and without bytes that a terminal would obey.
inline std::string shown(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
    return text + (word.size() > 40 ? "..." : "");
}
inline std::string in_quotes(std::string_view word) { return '"' + shown(word) + '"'; }

// Every line ends in '\n', the last one in a copy if need be: so no word runs beyond the text, and only next_line()
// has to look for its end.
class TextCursor {
public:
    // first_line: its number.  joins_lines: a backslash at the end of a line continues it.
    explicit TextCursor(std::string_view text, size_t first_line = 1, bool joins_lines = false) :
        line_(first_line), joins_lines_(joins_lines) {
        if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3); // byte order mark
        const size_t lines = text.rfind('\n') + 1;                      // bytes of the whole lines
        if (lines < text.size()) {
            last_line_ = text.substr(lines);
            last_line_ += '\n';
        }
        at_ = text.data();
        end_ = at_ + lines;
        if (at_ == end_) enter_last_line();
    }
    TextCursor(const TextCursor&) = delete;
    TextCursor& operator=(const TextCursor&) = delete;

    size_t line() const { return line_; }
    // Between two lines only.
    bool at_end() const { return at_ == end_; }
    const char* place() const { return at_; }
    // The next character but one; valid only if the next is no '\n'.
    char peek(size_t ahead = 0) const { return at_[ahead]; }
    void skip(size_t count) { at_ += count; }

    bool word_ends(size_t ahead = 0) const { return ends_at(at_ + ahead); }
    std::string_view word_at(const char* first) const {
        const char* stop = first;
        while (!ends_at(stop)) ++stop;
        return std::string_view(first, static_cast<size_t>(stop - first));
    }
    std::string_view word() const { return word_at(at_); }

    // Goes to the next word of this line, if there is one before a comment.
    bool more() {
        for (;;) {
            const char* place = at_;
            while (is_blank(*place)) ++place;
            at_ = place;
            if (*at_ == '\n' || *at_ == '#') return false;
            if (*at_ != '\\' || !continues_at(at_)) return true;
            at_ += at_[1] == '\n' ? 2 : 3;
            ++line_;
            if (at_ == end_) enter_last_line();
            if (at_ == end_) --at_; // the line end of before
        }
    }

    void next_line() {
        const bool comment = *at_ == '#';
        for (;;) {
            const char* stop = at_;
            if (*stop != '\n')
                stop = static_cast<const char*>(std::memchr(stop, '\n', static_cast<size_t>(end_ - stop)));
            const bool joined =
                !comment && stop != at_ && (continues_at(stop - 1) || (stop - at_ > 1 && continues_at(stop - 2)));
            at_ = stop + 1;
            ++line_;
            if (at_ == end_) enter_last_line();
            if (!joined || at_ == end_) return;
        }
    }

    // Goes to the next word of the text, over line ends and comments.
    bool more_lines() {
        while (!at_end()) {
            if (more()) return true;
            next_line();
        }
        return false;
    }

    // A finite number, correctly rounded.
    template <typename Real>
    Real number() {
        const char* const first = at_ + (*at_ == '+' && at_[1] != '-' ? 1 : 0);
        Real value = 0;
        std::from_chars_result parsed = std::from_chars(first, end_, value);
        double wide = 0;
        if (parsed.ec == std::errc::result_out_of_range && sizeof(Real) < sizeof wide
            && std::from_chars(first, end_, wide).ec == std::errc() && std::fabs(wide) < 1) {
            value = static_cast<Real>(wide); // nothing for a float, written by a program that had doubles
            parsed.ec = std::errc();
        }
        if (parsed.ec == std::errc::invalid_argument || !ends_at(parsed.ptr))
            fail(in_quotes(word()) + " is not a number; one like -1.5e-3 is expected");
        if (parsed.ec == std::errc::result_out_of_range)
            fail(in_quotes(word()) + " is too large or too small for a number of " + std::to_string(8 * sizeof(Real))
                 + " bits; scale the mesh");
        if (!std::isfinite(value)) fail("the coordinate " + in_quotes(word()) + " is not finite; repair the vertex");
        at_ = parsed.ptr;
        return value;
    }

    // Digits; false where there are none.  What is far too large becomes the largest value.
    bool digits(uint64_t& value) {
        const char* stop = at_;
        uint64_t sum = 0;
        for (; *stop >= '0' && *stop <= '9'; ++stop) sum = 10 * sum + static_cast<uint64_t>(*stop - '0');
        const bool found = stop != at_;
        value = stop - at_ <= 19 ? sum : UINT64_MAX; // 10^19 < 2^64
        at_ = stop;
        return found;
    }

    // A word that is a whole number from 0.
    uint64_t whole(const char* what) {
        const char* const first = at_;
        uint64_t value = 0;
        if (!digits(value) || !ends_at(at_))
            fail(in_quotes(word_at(first)) + " is not " + what + "; a whole number from 0 is expected");
        return value;
    }

    [[noreturn]] void fail(const std::string& sentence) const { throw MeshError(sentence, line_); }

private:
    static bool is_blank(char c) { return c == ' ' || (c != '\n' && c >= '\t' && c <= '\r'); }
    bool ends_at(const char* place) const {
        const char c = *place;
        return c == ' ' || (c >= '\t' && c <= '\r') || (c == '\\' && continues_at(place));
    }
    bool continues_at(const char* place) const {
        return joins_lines_ && *place == '\\' && (place[1] == '\n' || (place[1] == '\r' && place[2] == '\n'));
    }
    // Behind the whole lines.
    void enter_last_line() {
        if (last_line_.empty() || end_ == last_line_.data() + last_line_.size()) return;
        at_ = last_line_.data();
        end_ = at_ + last_line_.size();
    }

    const char* at_;
    const char* end_;
    size_t line_;
    bool joins_lines_;
    std::string last_line_; // ends in '\n', or is empty
};

} // namespace readers
