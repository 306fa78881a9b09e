/* Places of a text that the code fills in. In the text as it lies in the repository they read right
 * by themselves: <!--@name@-->what is read there<!--@-->, of which a reader of Markdown sees what
 * stands between. */
#ifndef FG_MANUAL_MARKS_H
#define FG_MANUAL_MARKS_H

#include <stdbool.h>
#include <stdio.h>

/* Writes the text with every fact in its place. False, and what is wrong in `wrong`: a fact that is
 * not known, a mark without an end, a number or word in the text that is not what the code says. A
 * fact of several lines (a table) replaces a sentence that says where it is. */
bool fg_manual_fill(const char *text, char wrong[200], FILE *out);

#endif
