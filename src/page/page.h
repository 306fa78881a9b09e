/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frame of every page, and text made harmless. A page is one file, without scripts. */
#ifndef FG_PAGE_PAGE_H
#define FG_PAGE_PAGE_H

#include <stdio.h>

/* Write a page from its doctype to its <main>, and its end. */
void fg_html_begin(FILE *out, const char *title);
void fg_html_head(FILE *out, const char *title); /* up to the style: for a page with its own */
extern const char fg_page_style[];               /* page.css, between <style> and </style> */
void fg_html_end(FILE *out);

/* Writes text with <, >, &, quotes and stray bytes made harmless. */
void fg_html_text(FILE *out, const char *text);

/* Writes a text that people gave, as a serial number or a file's name: in every language as it is.
 */
void fg_html_name(FILE *out, const char *text);

#endif
